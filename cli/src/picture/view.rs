//! The three views of a scene, and where points of the world lie in them. A view has no scale.

use creatures::record::Scene;
use glam::{DVec2, DVec3};

/// A way to look at the world, without perspective.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Its name beside its row.
    pub(super) name: &'static str,
    /// Towards the right of the picture.
    right: DVec3,
    /// Towards its top.
    top: DVec3,
    /// Out of it, to who looks at it.
    near: DVec3,
}

impl View {
    /// From the creature's right, which looks to the right of the picture.
    pub(super) fn side(scene: &Scene) -> View {
        View { name: "side", right: scene.forward, top: scene.up, near: scene.forward.cross(scene.up) }
    }

    /// From above; it looks to the right of the picture.
    pub(super) fn above(scene: &Scene) -> View {
        View { name: "above", right: scene.forward, top: scene.up.cross(scene.forward), near: scene.up }
    }

    /// From ahead; it looks out of the picture.
    pub(super) fn front(scene: &Scene) -> View {
        View { name: "front", right: scene.up.cross(scene.forward), top: scene.up, near: scene.forward }
    }

    /// Where a point or a direction of the world lies in the picture.
    pub(super) fn flat(&self, point: DVec3) -> DVec2 {
        DVec2::new(self.right.dot(point), self.top.dot(point))
    }

    /// How near it is to who looks; larger is nearer.
    pub(super) fn nearness(&self, point: DVec3) -> f64 {
        self.near.dot(point)
    }

    /// Whether up is up in this view, so that the ground is seen from its edge.
    pub(super) fn is_upright(&self, scene: &Scene) -> bool {
        self.top == scene.up
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flyers: X to their left, Y up, Z forward.
    #[test]
    fn what_is_ahead_left_or_above_lies_where_a_draughtsman_puts_it() {
        let scene = Scene {
            length_unit: "m".into(),
            time_unit: "s".into(),
            step: 0.1,
            up: DVec3::Y,
            forward: DVec3::Z,
            creatures: vec![],
            parts: vec![],
            props: vec![],
            muscles: vec![],
            cords: vec![],
        };
        let (ahead, left, above) = (DVec3::Z, DVec3::X, DVec3::Y);
        let side = View::side(&scene);
        assert_eq!((side.flat(ahead), side.flat(above)), (DVec2::X, DVec2::Y));
        assert_eq!(side.nearness(left), -1.0);
        let top = View::above(&scene);
        assert_eq!((top.flat(ahead), top.flat(left)), (DVec2::X, DVec2::Y));
        assert_eq!(top.nearness(above), 1.0);
        let front = View::front(&scene);
        assert_eq!((front.flat(left), front.flat(above)), (DVec2::X, DVec2::Y));
        assert_eq!(front.nearness(ahead), 1.0);
        let upright = [side, top, front].map(|view| view.is_upright(&scene));
        assert_eq!(upright, [true, false, true]);
    }
}
