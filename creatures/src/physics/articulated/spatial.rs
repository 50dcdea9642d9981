//! Six-vectors and 6×6 matrices: the algebra of rigid bodies that share one reference point.
//! It knows nothing of bodies, joints or contacts.
//!
//! Every twist and every wrench of a step is taken at the *same* point of the world and in world axes, so
//! that a child's inertia joins its parent's by plain addition; no frame is ever changed.

use glam::{DMat3, DVec3};

/// A twist (velocity of the body at the reference point, angular velocity) or a wrench's impulse (linear,
/// angular about the reference point), world axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Six(pub(super) [f64; 6]);

impl Six {
    pub(super) const ZERO: Six = Six([0.0; 6]);

    pub(super) fn new(linear: DVec3, angular: DVec3) -> Six {
        Six([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z])
    }

    pub(super) fn linear(&self) -> DVec3 {
        DVec3::new(self.0[0], self.0[1], self.0[2])
    }

    pub(super) fn angular(&self) -> DVec3 {
        DVec3::new(self.0[3], self.0[4], self.0[5])
    }

    pub(super) fn dot(&self, other: &Six) -> f64 {
        let (a, b) = (&self.0, &other.0);
        (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
    }

    /// `self += other · scale`.
    pub(super) fn add_scaled(&mut self, other: &Six, scale: f64) {
        for i in 0..6 {
            self.0[i] += other.0[i] * scale;
        }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.0.iter().all(|x| x.is_finite())
    }
}

/// A 6×6 matrix that maps a twist to an impulse, by columns: the inertia of a body, or of everything that
/// hangs on it. Symmetric, except where sliding friction follows the normal impulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Inertia(pub(super) [[f64; 6]; 6]);

impl Inertia {
    pub(super) const ZERO: Inertia = Inertia([[0.0; 6]; 6]);

    /// A rigid body of a mass and a rotational inertia about its centre, which lies at `r` from the
    /// reference point.
    pub(super) fn rigid(mass: f64, inertia: DMat3, r: DVec3) -> Inertia {
        let (m, s) = (mass, r * mass);
        let rr = s.dot(r);
        let i = inertia.to_cols_array_2d();
        let (x, y, z) = (r.x, r.y, r.z);
        let xx = i[0][0] + (rr - s.x * x);
        let yy = i[1][1] + (rr - s.y * y);
        let zz = i[2][2] + (rr - s.z * z);
        let (xy, xz, yz) = (i[0][1] - s.x * y, i[0][2] - s.x * z, i[1][2] - s.y * z);
        Inertia([
            [m, 0.0, 0.0, 0.0, s.z, -s.y],
            [0.0, m, 0.0, -s.z, 0.0, s.x],
            [0.0, 0.0, m, s.y, -s.x, 0.0],
            [0.0, -s.z, s.y, xx, xy, xz],
            [s.z, 0.0, -s.x, xy, yy, yz],
            [-s.y, s.x, 0.0, xz, yz, zz],
        ])
    }

    pub(super) fn times(&self, v: &Six) -> Six {
        let mut sum = [0.0; 6];
        for (column, x) in self.0.iter().zip(v.0) {
            for (total, entry) in sum.iter_mut().zip(column) {
                *total += entry * x;
            }
        }
        Six(sum)
    }

    /// The transpose times a vector.
    pub(super) fn transposed_times(&self, v: &Six) -> Six {
        Six(self.0.map(|column| Six(column).dot(v)))
    }

    pub(super) fn add(&mut self, other: &Inertia) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            for (a, b) in mine.iter_mut().zip(theirs) {
                *a += b;
            }
        }
    }

    /// `self += scale · u wᵀ`.
    pub(super) fn add_outer(&mut self, u: &Six, w: &Six, scale: f64) {
        for (column, x) in self.0.iter_mut().zip(w.0) {
            let factor = x * scale;
            for (entry, y) in column.iter_mut().zip(u.0) {
                *entry += y * factor;
            }
        }
    }

    /// The twist that an impulse gives: `self⁻¹ · impulse`, by LU without exchanges; none if a pivot is not
    /// positive.
    #[allow(clippy::needless_range_loop, reason = "the indices are those of the textbook's triangles")]
    pub(super) fn solve(&self, impulse: &Six) -> Option<Six> {
        let mut a = self.0;
        let mut x = impulse.0;
        let mut inverse = [0.0; 6];
        for k in 0..6 {
            let pivot = a[k][k];
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            inverse[k] = 1.0 / pivot;
            for j in k + 1..6 {
                let factor = a[j][k] * inverse[k];
                for i in k + 1..6 {
                    a[j][i] -= a[k][i] * factor;
                }
            }
            let factor = x[k] * inverse[k];
            for i in k + 1..6 {
                x[i] -= a[k][i] * factor;
            }
        }
        for k in (0..6).rev() {
            let mut rest = x[k];
            for j in k + 1..6 {
                rest -= a[j][k] * x[j];
            }
            x[k] = rest * inverse[k];
        }
        Some(Six(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_momentum_of_a_rigid_body_is_that_of_its_centre_and_its_spin() {
        let (mass, r) = (2.0, DVec3::new(0.3, -0.2, 0.5));
        let inertia = DMat3::from_diagonal(DVec3::new(0.1, 0.2, 0.3));
        let (v, w) = (DVec3::new(1.0, 2.0, -0.5), DVec3::new(-1.0, 0.4, 3.0));
        let at_reference = Six::new(v - w.cross(r), w);
        let momentum = Inertia::rigid(mass, inertia, r).times(&at_reference);
        assert!((momentum.linear() - mass * v).length() < 1e-14);
        assert!((momentum.angular() - (inertia * w + r.cross(mass * v))).length() < 1e-14);
    }

    #[test]
    fn solving_undoes_multiplying_and_refuses_what_is_not_positive() {
        let mut a = Inertia::rigid(2.0, DMat3::from_diagonal(DVec3::ONE), DVec3::new(1.0, 2.0, 3.0));
        a.add_outer(&Six([1.0, -2.0, 0.5, 3.0, 0.0, 1.0]), &Six([1.5, -2.0, 0.5, 3.0, 0.2, 1.0]), 0.7);
        let x = Six([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let back = a.solve(&a.times(&x)).unwrap();
        assert!(back.0.iter().zip(x.0).all(|(a, b)| (a - b).abs() < 1e-12));
        let x_axis = Six([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        a.add_outer(&x_axis, &x_axis, -100.0);
        assert_eq!(a.solve(&x), None);
        assert_eq!(Inertia([[f64::NAN; 6]; 6]).solve(&x), None);
    }
}
