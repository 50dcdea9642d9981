//! A short run of every body on the stable toolchain: the corpus as it is, and then so many mutations of it, drawn
//! from keyed streams, so that a run that fails fails again. It sees no coverage; libFuzzer does.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says where it failed")]

use creatures::random::{Stream, stream};
use hatchery_fuzz::{TARGETS, Target};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// Mutations of a target's corpus, unless `HATCHERY_FUZZ_RUNS` says otherwise.
const RUNS: u32 = 30_000;
/// No input grows beyond this, bytes.
const SIZE_MAX: usize = 1 << 16;

#[test]
fn no_decoder_panics_on_its_corpus_or_near_it() {
    let runs = std::env::var("HATCHERY_FUZZ_RUNS").map_or(RUNS, |text| text.parse().unwrap());
    std::panic::set_hook(Box::new(|_| {})); // each is caught, and told below with its input
    let crashes: Vec<String> = std::thread::scope(|scope| {
        let running: Vec<_> = TARGETS.map(|target| scope.spawn(move || run(target, runs))).into();
        running.into_iter().filter_map(|one| one.join().unwrap()).collect()
    });
    drop(std::panic::take_hook());
    assert!(crashes.is_empty(), "{}", crashes.join("\n"));
}

/// The first input at which a body panics, in words.
fn run((name, body): (&str, Target), runs: u32) -> Option<String> {
    let corpus = corpus(name);
    assert!(!corpus.is_empty(), "fuzz/corpus/{name} is empty");
    for (path, input) in &corpus {
        if let Err(panic) = attempt(body, input) {
            return Some(format!("{name}: {}: {panic}", path.display()));
        }
    }
    for run in 0..runs {
        let mut draws = stream(1, [run, 0, 0], name);
        let (_, input) = &corpus[draws.below(corpus.len())];
        let (_, other) = &corpus[draws.below(corpus.len())];
        let input = mutate(&mut draws, input.clone(), other);
        if let Err(panic) = attempt(body, &input) {
            let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{run}"));
            std::fs::write(&path, &input).unwrap();
            return Some(format!("{name}: {} (kept for the corpus): {panic}", path.display()));
        }
    }
    None
}

fn attempt(body: Target, input: &[u8]) -> Result<(), String> {
    catch_unwind(AssertUnwindSafe(|| body(input))).map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        text.or_else(|| panic.downcast_ref::<&str>().map(|text| (*text).to_owned())).unwrap_or_default()
    })
}

/// The inputs kept for a target, by name.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), std::fs::read(path).unwrap())).collect()
}

/// One to eight small changes, as a careless or a hostile sender would make them.
fn mutate(draws: &mut Stream, mut input: Vec<u8>, other: &[u8]) -> Vec<u8> {
    const NUMBERS: [&str; 10] =
        ["0", "-1", "1e308", "-1e-308", "NaN", "18446744073709551616", "4294967295", "null", "[]", "\"\""];
    const BYTES: [u8; 8] = [0, 1, 0x7f, 0x80, 0xff, 0xfb, 0xf6, 0x9f]; // edges, and CBOR's float, null and open array
    for _ in 0..draws.within(1, 8) {
        let at = draws.below(input.len() + 1);
        let end = (at + draws.within(1, 16)).min(input.len());
        match draws.below(9) {
            0 if at < input.len() => input[at] ^= 1 << draws.below(8),
            1 if at < input.len() => input[at] = BYTES[draws.below(BYTES.len())],
            2 => drop(input.drain(at..end)),
            3 => drop(input.splice(at..end, BYTES[..draws.within(1, 8)].iter().copied())),
            4 => {
                let copy = input[at..end].to_vec();
                drop(input.splice(at..at, copy));
            }
            5 if !other.is_empty() => {
                let from = draws.below(other.len());
                let to = (from + draws.within(1, 64)).min(other.len());
                drop(input.splice(at..end, other[from..to].iter().copied()));
            }
            6 => drop(input.splice(at..end, NUMBERS[draws.below(NUMBERS.len())].bytes())),
            7 if at + 8 <= input.len() => {
                let float = [f64::NAN, f64::INFINITY, -0.0, f64::MAX, f64::MIN_POSITIVE][draws.below(5)];
                let bytes = if draws.chance(0.5) { float.to_be_bytes() } else { float.to_le_bytes() };
                input[at..at + 8].copy_from_slice(&bytes);
            }
            _ => input.truncate(input.len() - draws.below(input.len() / 4 + 1)),
        }
    }
    input.truncate(SIZE_MAX);
    input
}

#[test]
fn every_target_has_its_libfuzzer_twin() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("libfuzzer");
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
    for (name, _) in TARGETS {
        let twin = std::fs::read_to_string(folder.join(format!("targets/{name}.rs"))).unwrap();
        assert!(twin.contains(&format!("hatchery_fuzz::{name}(")), "targets/{name}.rs runs something else");
        assert!(manifest.contains(&format!("name = \"{name}\"")), "libfuzzer/Cargo.toml has no `{name}`");
    }
}
