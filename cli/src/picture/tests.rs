use super::*;
use creatures::record::{Keeper, Part, Pose, Recording, Shape};
use creatures::system;
use glam::DVec3;

/// The first trial of a system's proof.
pub(super) fn recorded(name: &str, proof: usize) -> Recording {
    let system = system(name).unwrap();
    let proof = &system.proofs()[proof];
    let mut keeper = Keeper::new(0, 1);
    let task = system.task(&proof.task).unwrap();
    task.evaluate(&proof.genotype, proof.seed, None, &mut keeper).unwrap();
    keeper.recording().unwrap()
}

pub(super) fn captions() -> [String; 2] {
    ["title".to_owned(), "subtitle".to_owned()]
}

/// How many pixels of the sheet are strongly coloured: paper, grid, letters and ground are not.
fn colourful(sheet: &Pixels) -> usize {
    let strong = |pixel: &&[u8]| pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 90;
    sheet.bytes.chunks_exact(3).filter(strong).count()
}

#[test]
fn every_kind_of_creature_leaves_ink_and_a_picture_that_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, proof) in [("walker", 0), ("flyer", 3), ("fish", 0), ("fish", 5), ("fish", 6)] {
        let recording = recorded(name, proof);
        let with = pixels(&recording, Layout::Contact, ["title", "subtitle"]).unwrap();
        let mut bare = recording.clone();
        bare.scene.parts.iter_mut().for_each(|part| part.shapes.clear());
        let without = pixels(&bare, Layout::Contact, ["title", "subtitle"]).unwrap();
        assert!(colourful(&with) > colourful(&without) + 2000, "{name} {proof}: {}", colourful(&with));
        let file = folder.path().join(format!("{name}-{proof}.png"));
        draw(&recording, Layout::Contact, &captions(), &file).unwrap();
        let png = std::fs::read(file).unwrap();
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert_eq!((side(16) * SHARP, side(20) * SHARP), with.size, "{name} {proof}");
    }
}

/// Muscles are lines upon the parts, in a colour that nothing else has, and thicker the more active they are.
#[test]
fn muscles_are_seen_by_how_active_they_are() {
    let recording = recorded("esp", 0);
    assert!(recording.shots.iter().any(|shot| shot.frame.muscles[0].iter().any(|&one| one > 0.9)));
    let red = |activation: f64| {
        let mut of = recording.clone();
        of.shots.iter_mut().for_each(|shot| shot.frame.muscles[0].fill(activation));
        let bytes = pixels(&of, Layout::Contact, ["", ""]).unwrap().bytes;
        bytes.chunks_exact(3).filter(|pixel| pixel[0] > 180 && pixel[1] < 90 && pixel[2] < 60).count()
    };
    let (slack, active) = (red(0.0), red(1.0));
    assert!(slack < 2000 && active > slack + 2000, "{slack} {active}");
}

#[test]
fn a_film_holds_still_while_its_fish_swims() {
    let mut recording = recorded("fish", 0);
    for (index, shot) in (0..).zip(&mut recording.shots) {
        let way = 0.5 * f64::from(index) * recording.scene.forward;
        shot.frame.centers[0] += way;
        let Pose::Nodes(nodes) = &mut shot.frame.poses[0] else { panic!("a fish has nodes") };
        nodes.iter_mut().for_each(|node| *node += way);
    }
    let sheet = Sheet::film(&recording);
    let cells: Vec<Pixels> = sheet.cells().map(|cell| cell.unwrap().1).collect();
    assert_eq!(cells.len(), 8);
    let strong = |pixel: &[u8]| pixel.iter().max().unwrap() - pixel.iter().min().unwrap() > 120;
    let front = |cell: &Pixels| {
        let places = cell.bytes.chunks_exact(3).enumerate().filter(|(_, pixel)| strong(pixel));
        places.map(|(place, _)| place as u32 % cell.size.0).max().unwrap()
    };
    assert!(front(&cells[7]) > front(&cells[0]), "{} and {}", front(&cells[0]), front(&cells[7]));
    let film = pixels(&recording, Layout::Film, ["title", "subtitle"]).unwrap();
    let sheet = pixels(&recording, Layout::Contact, ["title", "subtitle"]).unwrap();
    assert!(colourful(&film) > 2000 && film.size.1 < sheet.size.1);
}

/// A light that is too far away for every view has its place in the way from above.
#[test]
fn a_light_that_no_view_reaches_is_on_the_way_from_above() {
    let mut recording = recorded("esp", 1);
    let is_light = |part: &Part| part.shapes.iter().any(|shape| matches!(shape, Shape::Light { .. }));
    let light = recording.scene.parts.iter().position(is_light).unwrap();
    recording
        .shots
        .iter_mut()
        .for_each(|shot| shot.frame.poses[light] = Pose::at(DVec3::new(50.0, 0.0, 0.3)));
    let yellow = |of: &Recording| {
        let bytes = pixels(of, Layout::Contact, ["", ""]).unwrap().bytes;
        bytes.chunks_exact(3).filter(|pixel| *pixel == [240, 200, 20]).count()
    };
    let seen = yellow(&recording);
    recording.scene.parts[light].shapes.clear();
    assert!(seen > 50 && yellow(&recording) == 0, "{seen}");
}

#[test]
fn a_creature_that_never_moved_is_drawn_at_its_start() {
    let mut recording = recorded("walker", 0);
    recording.shots.truncate(1);
    assert!(colourful(&pixels(&recording, Layout::Contact, ["", ""]).unwrap()) > 1000);
    recording.shots.clear();
    assert!(pixels(&recording, Layout::Contact, ["", ""]).err().unwrap().to_string().contains("no frame"));
}

#[test]
fn a_file_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("missing").join("a.png");
    let error = draw(&recorded("fish", 0), Layout::Contact, &captions(), &file).unwrap_err();
    assert!(format!("{error:#}").contains("missing/a.png"), "{error:#}");
}

#[test]
fn shrinking_averages_and_pasting_stays_within() {
    let mut large = Pixels { size: (4, 2), bytes: vec![0; 24] };
    large.paste(&Pixels { size: (3, 3), bytes: vec![200; 27] }, (2, 1));
    let small = shrunk(&large);
    assert_eq!((small.size, small.bytes), ((2, 1), vec![0, 0, 0, 100, 100, 100]));
}
