//! Small experiments, large enough to have parents, and short enough for a debug build.

/// An experiment of one run: its tables as given, one key a line.
fn file(name: &str, system: &str, seed: u64, task: &str, search: &str) -> String {
    format!(
        "name = \"{name}\"\nsystem = \"{system}\"\nseed = {seed}\nruns = 1\n\n[task]\n{task}\n\n[search]\n{search}\n"
    )
}

/// Probe individuals: `work` hash compressions each (about 0.1 µs apiece in a release build, a few µs in debug).
pub fn probe(seed: u64, population: u32, generations: u32, work: u32) -> String {
    let search =
        format!("kind = \"probe\"\npopulation = {population}\ngenerations = {generations}\npayload = 256");
    file("probe", "probe", seed, &format!("work = {work}"), &search)
}

/// Probe individuals in stages, each with a task of its own, with a pick between them by `best` or `human`.
pub fn staged(seed: u64, population: u32, generations: u32, stages: u32, pick: &str) -> String {
    let text = probe(seed, population, generations, 3);
    format!("{text}stages = {stages}\npick = \"{pick}\"\ngrowth = 2\n")
}

/// Walkers of a body under `grn` or `neat`, for one simulated second each.
pub fn walkers(body: &str, kind: &str, seed: u64, population: u32, generations: u32) -> String {
    let task = format!("body = \"{body}\"\nseconds = 1.0");
    let search = format!("kind = \"{kind}\"\npopulation = {population}\ngenerations = {generations}");
    file(&format!("{body}-{kind}"), "walker", seed, &task, &search)
}

/// Flyers, for ten simulated seconds each.
pub fn flyers(seed: u64, population: u32, generations: u32) -> String {
    let search = format!("kind = \"generational\"\npopulation = {population}\ngenerations = {generations}");
    file("flyers", "flyer", seed, "steps = 200", &search)
}

/// Fishes that anneal a straight swim of a third of the published time.
pub fn fishes(seed: u64, chains: u32, steps: u32) -> String {
    let search = format!("kind = \"anneal\"\nchains = {chains}\nsteps = {steps}");
    file("fishes", "fish", seed, "scenario = \"drill\"\nlesson.steps = 60", &search)
}

/// Fishes that go through a whole curriculum: practice, a race and the buoys.
pub fn curriculum(seed: u64, chains: u32, steps: u32) -> String {
    let task = r#"
scenario = "learning"
lessons = [{ steps = 60 }, { steps = 60, approach = 100, objective.criterion.heading_degrees = 30 }]
race.steps = 120
buoys.steps = 120"#;
    let search = format!("kind = \"learning\"\nchains = {chains}\nsteps = {steps}");
    file("curriculum", "fish", seed, task, &search)
}

/// The same in six runs, culled a quarter of the way: a fifth of those that stand worst against the previous generation.
pub fn culled(text: &str) -> String {
    let text = text.replace("runs = 1", "runs = 6");
    format!("{text}\n[culling]\nat = 0.25\nfraction = 0.9\ncontrol = 0.2\n")
}

/// The same, with a share of its evaluations audited.
pub fn audited(text: &str, share: f64) -> String {
    text.replace("runs = 1", &format!("runs = 1\naudit = {share:?}"))
}
