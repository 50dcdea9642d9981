//! Films: the rigid triangles between two bones on which the air bears (F-20, F-21), and whether two of them
//! cross (F-23). It knows no bones, no air and no motion.

use glam::{DMat3, DVec3};

/// Smaller triangles are no films, m² (F-20).
const AREA_MIN: f64 = 1e-6;
/// How much a film shrinks about its centroid before it is tested, so that a shared corner or bone is no
/// crossing (F-23).
const SHRINK: f64 = 1e-3;
/// A film whose corners are all this near another's plane lies in it, m (F-23).
const COPLANAR: f64 = 1e-6;
/// How far outside a triangle a point still counts as within it, as a share of the triangle's area. The wings
/// start as mirror images, so that edges which cross meet exactly *on* each other; without this, rounding
/// would decide.
const RIM: f64 = 1e-9;

/// A triangle of film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Film {
    /// The anchor that its two bones share, the end of the child, and the parent's end away from the anchor,
    /// m, in whatever frame the film is looked at.
    pub corners: [DVec3; 3],
}

impl Film {
    /// The film between three corners; none if they (nearly) lie on one line, as at Ψ = 0.
    pub fn between(corners: [DVec3; 3]) -> Option<Film> {
        let film = Film { corners };
        (film.area() >= AREA_MIN).then_some(film)
    }

    /// The same film seen from a frame in which its own has this rotation and origin.
    pub fn seen(&self, rotation: DMat3, origin: DVec3) -> Film {
        Film { corners: self.corners.map(|corner| origin + rotation * corner) }
    }

    /// m².
    pub fn area(&self) -> f64 {
        0.5 * self.across().length()
    }

    /// Unit length; which of the two sides it points to does not matter to the air (F-43).
    pub fn normal(&self) -> DVec3 {
        self.across().normalize()
    }

    /// The centroids of the four triangles, equal in area, into which the edges' midpoints split the film:
    /// the points on which the air acts (F-21).
    pub fn centroids(&self) -> [DVec3; 4] {
        let [a, b, c] = self.corners;
        let sum = a + b + c;
        [(sum + 3.0 * a) / 6.0, (sum + 3.0 * b) / 6.0, (sum + 3.0 * c) / 6.0, sum / 3.0]
    }

    /// Whether two films of one frame cross or overlap (F-23). Corners and bones that they share do not
    /// count.
    pub fn crosses(&self, other: &Film) -> bool {
        let (a, b) = (self.shrunk(), other.shrunk());
        if a.lies_in_plane_of(&b) || b.lies_in_plane_of(&a) {
            return a.overlaps(&b);
        }
        a.pierces(&b) || b.pierces(&a)
    }

    /// Normal of twice the area's length.
    fn across(&self) -> DVec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    fn edges(&self) -> [(DVec3, DVec3); 3] {
        let [a, b, c] = self.corners;
        [(a, b), (b, c), (c, a)]
    }

    fn shrunk(&self) -> Film {
        let [a, b, c] = self.corners;
        let centroid = (a + b + c) / 3.0;
        Film { corners: self.corners.map(|corner| corner + SHRINK * (centroid - corner)) }
    }

    /// Signed, m.
    fn height_of(&self, point: DVec3) -> f64 {
        self.normal().dot(point - self.corners[0])
    }

    fn lies_in_plane_of(&self, other: &Film) -> bool {
        self.corners.into_iter().all(|corner| other.height_of(corner).abs() <= COPLANAR)
    }

    /// Whether two triangles of one plane have a point in common: no edge of either separates them.
    fn overlaps(&self, other: &Film) -> bool {
        let normal = self.normal();
        let axes = self.edges().into_iter().chain(other.edges()).map(|(from, to)| normal.cross(to - from));
        axes.into_iter().all(|axis| {
            let ((low, high), (other_low, other_high)) = (self.extent(axis), other.extent(axis));
            low <= other_high && other_low <= high
        })
    }

    /// Between which values its corners lie along an axis.
    fn extent(&self, axis: DVec3) -> (f64, f64) {
        let [a, b, c] = self.corners.map(|corner| axis.dot(corner));
        (a.min(b).min(c), a.max(b).max(c))
    }

    /// Whether an edge of this film passes through the other.
    fn pierces(&self, other: &Film) -> bool {
        self.edges().into_iter().any(|(from, to)| {
            let (above, below) = (other.height_of(from), other.height_of(to));
            let apart = above - below;
            // An edge along the plane passes through nothing; what it lies on, the other's edges find.
            above * below <= 0.0 && apart != 0.0 && other.holds(from + (to - from) * (above / apart))
        })
    }

    /// Whether a point of its plane is within the triangle or on its rim.
    fn holds(&self, point: DVec3) -> bool {
        let across = self.across();
        let rim = -RIM * across.length_squared();
        self.edges().into_iter().all(|(from, to)| across.dot((to - from).cross(point - from)) >= rim)
    }
}

#[cfg(test)]
mod tests;
