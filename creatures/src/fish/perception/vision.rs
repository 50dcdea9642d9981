//! What an eye sees: whatever has a sample point within reach, within the cone of sight and not
//! behind something opaque.

use super::scene::Shadow;
use super::{Figure, Senses};
use crate::fish::world::{FishId, Obstacle};
use glam::DVec3;

/// Cosine of half the field of view, 150°: only a cone astern is blind.
pub(super) const COS_HALF_FIELD: f64 = -0.866_025_403_784_438_6;

/// Whether a fish's outline is seen in part.
pub fn sees_fish(senses: &Senses<'_>, figure: &Figure) -> bool {
    // Nothing of it can be in reach if its nose is more than a body length out of it.
    let far = senses.habits.vision + 2.0 * figure.length();
    (figure.mouth - senses.me.eye).length_squared() < far * far
        && figure.outline.iter().any(|&point| sees_point(senses, point, Some(figure.id)))
}

/// Whether an obstacle of the scene is seen in part.
pub fn sees_obstacle(senses: &Senses<'_>, index: usize) -> bool {
    let outline = senses.scene.obstacles[index].outline(senses.me.eye);
    outline.iter().any(|&point| in_field(senses, point) && clear(senses, point, None, Some(index)))
}

/// Whether a point is seen; `of` is the fish that it belongs to, which does not hide itself.
pub fn sees_point(senses: &Senses<'_>, point: DVec3, of: Option<FishId>) -> bool {
    in_field(senses, point) && clear(senses, point, of, None)
}

/// Within V_r of the eye and not in the blind cone astern.
fn in_field(senses: &Senses<'_>, point: DVec3) -> bool {
    let way = point - senses.me.eye;
    let distance = way.length();
    distance <= senses.habits.vision && way.dot(senses.me.forward) >= COS_HALF_FIELD * distance
}

/// Whether nothing opaque stands between the eye and a point, the viewer and the owner of the point aside.
fn clear(senses: &Senses<'_>, point: DVec3, fish: Option<FishId>, obstacle: Option<usize>) -> bool {
    let (eye, scene) = (senses.me.eye, senses.scene);
    let way = point - eye;
    let distance = way.length();
    let Some(direction) = way.try_normalize() else { return true };
    let blocks = |(index, solid): (usize, &Obstacle)| {
        Some(index) != obstacle && solid.hit(eye, direction, distance, 0.0).is_some()
    };
    if scene.obstacles.iter().enumerate().any(blocks) {
        return false;
    }
    let hides = |shadow: &Shadow| {
        shadow.meets(eye, direction, distance) && shadow.id != senses.me.id && Some(shadow.id) != fish
    };
    !senses.shadows.iter().any(hides)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fish::perception::tests::Pond;
    use crate::fish::world::Obstacle;

    fn polar(bearing_degrees: f64, distance: f64) -> DVec3 {
        let angle = bearing_degrees.to_radians();
        DVec3::new(-crate::math::sin(angle), crate::math::cos(angle), 0.0) * distance
    }

    /// T-22: the eye at 0 looks along y and sees 300 far.
    #[test]
    fn sight_ends_at_its_radius_and_at_the_blind_cone() {
        let pond = Pond::with_eye_at_origin();
        let sees = |point| pond.senses(0, |senses| sees_point(senses, point, None));
        for side in [1.0, -1.0] {
            assert!(sees(polar(side * 149.0, 10.0)) && !sees(polar(side * 151.0, 10.0)));
        }
        assert!(sees(polar(0.0, 299.0)) && !sees(polar(0.0, 301.0)));
        assert!(sees(DVec3::ZERO), "AF-9: what is on the eye");
    }

    /// T-22
    #[test]
    fn what_is_behind_a_sphere_is_hidden_unless_a_part_looks_out() {
        let mut pond = Pond::with_eye_at_origin();
        pond.obstacles.push(Obstacle::Sphere { center: [0.0, 30.0, 0.0], radius: 5.0 });
        let behind = DVec3::new(0.0, 50.0, 0.0);
        assert!(!pond.senses(0, |senses| sees_point(senses, behind, None)));
        assert!(pond.senses(0, |senses| sees_point(senses, DVec3::new(0.0, 20.0, 0.0), None)));
        assert!(pond.senses(0, |senses| sees_obstacle(senses, 0)));
        pond.add(DVec3::new(0.0, 60.0, 0.0), std::f64::consts::FRAC_PI_2);
        assert!(pond.senses(0, |senses| sees_fish(senses, &senses.scene.figures[1])), "half behind it");
        pond.obstacles.push(Obstacle::Box { center: [0.0, 40.0, 0.0], half: [60.0, 1.0, 60.0] });
        assert!(!pond.senses(0, |senses| sees_fish(senses, &senses.scene.figures[1])));
    }

    #[test]
    fn a_fish_hides_what_is_behind_it_but_not_itself() {
        let mut pond = Pond::with_eye_at_origin();
        pond.add(DVec3::new(0.0, 40.0, 0.0), std::f64::consts::FRAC_PI_2);
        assert!(pond.senses(0, |senses| sees_fish(senses, &senses.scene.figures[1])));
        assert!(!pond.senses(0, |senses| sees_point(senses, DVec3::new(0.0, 90.0, 0.0), None)));
    }
}
