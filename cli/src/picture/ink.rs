//! What is drawn in which colour. The colours stay apart for the colour-blind (Okabe and Ito).

use creatures::record::{Part, Scene};
use plotters::style::RGBColor;

pub(super) const PAPER: RGBColor = RGBColor(255, 255, 255);
pub(super) const TEXT: RGBColor = RGBColor(40, 40, 40);
pub(super) const GRID: RGBColor = RGBColor(228, 230, 234);
pub(super) const FRAME: RGBColor = RGBColor(190, 190, 190);
pub(super) const EARTH: RGBColor = RGBColor(222, 214, 200);
pub(super) const EARTH_LINE: RGBColor = RGBColor(140, 125, 100);
pub(super) const PROP: RGBColor = RGBColor(175, 180, 185);
pub(super) const TRAIL: RGBColor = RGBColor(204, 121, 167);
pub(super) const LIGHT: RGBColor = RGBColor(240, 200, 20);

const SLACK: RGBColor = RGBColor(95, 95, 105);
const TENSE: RGBColor = RGBColor(213, 40, 0);
const TRUNK: RGBColor = RGBColor(150, 150, 155);
const LEFT: RGBColor = RGBColor(86, 180, 233);
const RIGHT: RGBColor = RGBColor(230, 159, 0);
/// What their colours say.
pub(super) const SIDES: [(&str, RGBColor); 2] = [("left", LEFT), ("right", RIGHT)];
/// Of kinds of creatures, in the order in which a scene has them.
const KINDS: [RGBColor; 4] =
    [RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(0, 114, 178), RGBColor(230, 159, 0)];

/// The colour of every part of a scene, in its order: of one creature left and right are told apart, of
/// several their kinds, which is their names up to the number; one whose muscles are drawn is grey, so that
/// these are seen.
pub(super) fn colours(scene: &Scene) -> Vec<RGBColor> {
    let kinds = kinds(scene);
    let colour = |part: &Part| match part.creature.and_then(|index| scene.creatures.get(index as usize)) {
        None => PROP,
        Some(_) if has_sides(scene) || !scene.cords.is_empty() => side(&part.name),
        Some(name) => of_kind(&kinds, name),
    };
    scene.parts.iter().map(colour).collect()
}

/// What the colours say.
pub(super) fn legend(scene: &Scene) -> Vec<(&str, RGBColor)> {
    if has_sides(scene) {
        return SIDES.to_vec();
    }
    if !scene.cords.is_empty() {
        return vec![("slack", SLACK), ("active", TENSE)];
    }
    let kinds = kinds(scene);
    kinds.iter().map(|kind| (*kind, of_kind(&kinds, kind))).collect()
}

/// Whether it is of one creature whose parts have sides.
fn has_sides(scene: &Scene) -> bool {
    scene.creatures.len() == 1 && scene.parts.iter().any(|part| side(&part.name) != TRUNK)
}

fn kinds(scene: &Scene) -> Vec<&str> {
    let mut kinds: Vec<&str> = Vec::new();
    for name in &scene.creatures {
        let kind = kind(name);
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    kinds
}

fn of_kind(kinds: &[&str], name: &str) -> RGBColor {
    let place = kinds.iter().position(|&other| other == kind(name)).unwrap_or(0);
    KINDS[place % KINDS.len()]
}

/// The colours of creatures, for their trails.
pub(super) fn trail(scene: &Scene, creature: usize) -> RGBColor {
    if scene.creatures.len() == 1 {
        return TRAIL;
    }
    let part = scene.parts.iter().position(|part| part.creature == Some(creature as u32));
    part.map_or(TRAIL, |part| colours(scene)[part])
}

fn kind(name: &str) -> &str {
    name.rsplit_once('_').map_or(name, |(kind, _)| kind)
}

/// The colour of a part's or a muscle's side, by its name.
pub(super) fn side(part: &str) -> RGBColor {
    if part.starts_with("left") {
        LEFT
    } else if part.starts_with("right") {
        RIGHT
    } else {
        TRUNK
    }
}

/// The colour of a muscle, by how active it is.
pub(super) fn muscle(activation: f64) -> RGBColor {
    let between = |slack: u8, tense: u8| {
        let (slack, tense) = (f64::from(slack), f64::from(tense));
        (slack + activation.clamp(0.0, 1.0) * (tense - slack)).round() as u8
    };
    RGBColor(between(SLACK.0, TENSE.0), between(SLACK.1, TENSE.1), between(SLACK.2, TENSE.2))
}

/// A colour under some light, 0 to 1.
pub(super) fn lit(colour: RGBColor, light: f64) -> RGBColor {
    let dim = |channel: u8| (f64::from(channel) * light.clamp(0.0, 1.0)).round() as u8;
    RGBColor(dim(colour.0), dim(colour.1), dim(colour.2))
}
