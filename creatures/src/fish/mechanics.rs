//! One step of a lattice in water: implicit Euler, linearised about where the nodes are, one factorisation and
//! one solve (A-12..A-15, A-18). It drives no muscle, and nothing here allocates once laid out.

use super::hydrodynamics::{Pressed, Water, pressed};
use super::lattice::{Lattice, Motion};
use super::skyline::{BadPivot, Skyline};
use glam::DVec3;

/// h, the length of a step, which is part of the model: implicit Euler damps by it.
pub const TIME_STEP: f64 = 0.055;

/// Springs shorter than this have lost their direction (A-20, AF-6).
const SPRING_LENGTH_MIN: f64 = 1e-6;

/// Why a lattice cannot go on (A-20, AF-6..AF-8).
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fault {
    /// The matrix of the step is not positive definite, or not made of numbers.
    #[error("pivot {0} of the step is not positive")]
    Pivot(usize),
    /// A position or a velocity is NaN or infinite.
    #[error("node {0} is nowhere")]
    NonFinite(usize),
    /// The ends of a spring have met.
    #[error("spring {0} has no length")]
    Collapsed(usize),
    /// A node is faster than the model means anything for.
    #[error("node {node} moves at {speed:.1}")]
    TooFast {
        /// Which node.
        node: usize,
        /// Its speed, length by time.
        speed: f64,
    },
}

/// The linear system of a step and where the parts of a lattice stand in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanics {
    matrix: Skyline,
    /// (springs), the block that couples its ends.
    spring_blocks: Vec<[usize; 3]>,
    /// (nodes), the block of a node with itself.
    node_blocks: Vec<[usize; 3]>,
    /// (3 nodes), the right side, then the solution.
    right: Vec<f64>,
    /// (nodes), Δx, the way of a node in this step.
    increments: Vec<DVec3>,
    /// (faces), of which the first so many push water in this step; laid out in full, so that a clone of it need
    /// not grow.
    pressed: Vec<Pressed>,
    pressed_count: usize,
    /// A node faster than this ends the evaluation, length by time.
    speed_max: f64,
    /// Linearisations a step.
    newton: u32,
}

impl Mechanics {
    /// Laid out for a lattice. `newton` is how often a step is linearised: once as published, at most four
    /// times; `speed_max` is the speed that no node may exceed.
    pub fn new(lattice: &Lattice, newton: u32, speed_max: f64) -> Mechanics {
        let nodes = lattice.masses.len();
        let matrix = Skyline::new(nodes, lattice.couplings());
        Mechanics {
            spring_blocks: lattice
                .springs
                .iter()
                .map(|spring| matrix.block(spring.ends[0], spring.ends[1]))
                .collect(),
            node_blocks: (0..nodes).map(|node| matrix.block(node, node)).collect(),
            matrix,
            right: vec![0.0; 3 * nodes],
            increments: vec![DVec3::ZERO; nodes],
            pressed: vec![Pressed::default(); lattice.faces.len()],
            pressed_count: 0,
            speed_max,
            newton,
        }
    }

    /// Moves a lattice by [`TIME_STEP`].
    ///
    /// `rest_lengths` (springs) are those at the end of the step, `forces` (nodes) come from outside and are
    /// explicit.
    ///
    /// # Errors
    /// What has gone out of bounds; the motion is then of no use.
    pub fn step(
        &mut self,
        lattice: &Lattice,
        motion: &mut Motion,
        rest_lengths: &[f64],
        forces: &[DVec3],
        water: &impl Water,
    ) -> Result<(), Fault> {
        self.press(lattice, motion, water);
        self.increments.fill(DVec3::ZERO);
        for _ in 0..self.newton {
            self.matrix.clear();
            self.add_inertia(lattice, motion, forces);
            self.add_springs(lattice, motion, rest_lengths)?;
            self.add_pressure();
            self.matrix.factorise().map_err(|BadPivot(index)| Fault::Pivot(index))?;
            self.matrix.solve(&mut self.right);
            for (increment, solved) in self.increments.iter_mut().zip(self.right.chunks_exact(3)) {
                *increment += DVec3::from_slice(solved);
            }
        }
        for ((position, velocity), &way) in
            motion.positions.iter_mut().zip(&mut motion.velocities).zip(&self.increments)
        {
            *velocity = way / TIME_STEP;
            *position += way;
        }
        self.check(motion)
    }

    /// Finds the faces that push water, as the step finds them.
    fn press(&mut self, lattice: &Lattice, motion: &Motion, water: &impl Water) {
        self.pressed_count = 0;
        for face in &lattice.faces {
            if let Some(face) = pressed(face, motion, water) {
                self.pressed[self.pressed_count] = face;
                self.pressed_count += 1;
            }
        }
    }

    /// M/h² + ρ/h on the left, M v/h − (M/h² + ρ/h) Δx + f on the right.
    fn add_inertia(&mut self, lattice: &Lattice, motion: &Motion, forces: &[DVec3]) {
        for (node, &mass) in lattice.masses.iter().enumerate() {
            let inertia = mass / (TIME_STEP * TIME_STEP) + lattice.damping / TIME_STEP;
            let columns = [[inertia, 0.0, 0.0], [0.0, inertia, 0.0], [0.0, 0.0, inertia]];
            self.matrix.add_diagonal(self.node_blocks[node], &columns);
            let right = motion.velocities[node] * (mass / TIME_STEP) - self.increments[node] * inertia;
            right_of(&mut self.right, node).copy_from_slice(&(right + forces[node]).to_array());
        }
    }

    /// K on the left, w on the right. A compressed spring resists sideways motion by nothing rather
    /// than by less than nothing, which keeps the matrix positive definite.
    fn add_springs(&mut self, lattice: &Lattice, motion: &Motion, rest_lengths: &[f64]) -> Result<(), Fault> {
        for (index, ((spring, &l), &block)) in
            lattice.springs.iter().zip(rest_lengths).zip(&self.spring_blocks).enumerate()
        {
            let [i, j] = spring.ends;
            let r = (motion.positions[j] + self.increments[j]) - (motion.positions[i] + self.increments[i]);
            let length = r.length();
            if length <= SPRING_LENGTH_MIN {
                return Err(Fault::Collapsed(index));
            }
            let c = spring.stiffness;
            let direction = r / length;
            let a = c * (1.0 - l / length);
            let force = direction * (c * (length - l));
            let a = if a > 0.0 { a } else { 0.0 };
            let mut stiffness = outer(direction, c - a);
            for (axis, column) in stiffness.iter_mut().enumerate() {
                column[axis] += a;
            }
            self.matrix.add_diagonal(self.node_blocks[i], &stiffness);
            self.matrix.add_diagonal(self.node_blocks[j], &stiffness);
            self.matrix.add(block, &stiffness.map(|column| column.map(|value| -value)));
            add_right(&mut self.right, i, force);
            add_right(&mut self.right, j, -force);
        }
        Ok(())
    }

    /// G on the left, g − G Δx on the right.
    fn add_pressure(&mut self) {
        for face in &self.pressed[..self.pressed_count] {
            let block = outer(face.normal, face.area * (1.0 / (9.0 * TIME_STEP)));
            let [a, b, c] = face.corners;
            for corner in face.corners {
                self.matrix.add_diagonal(self.node_blocks[corner], &block);
            }
            for (one, other) in [(a, b), (b, c), (a, c)] {
                let place = self.matrix.block(one.min(other), one.max(other));
                self.matrix.add(place, &block);
            }
            let way = self.increments[a] + self.increments[b] + self.increments[c];
            let third = face.force(way / (3.0 * TIME_STEP)) / 3.0;
            for corner in face.corners {
                add_right(&mut self.right, corner, third);
            }
        }
    }

    /// A-20; springs are looked at before every linearisation.
    fn check(&self, motion: &Motion) -> Result<(), Fault> {
        for (node, velocity) in motion.velocities.iter().enumerate() {
            let speed = velocity.length();
            if !(speed.is_finite() && motion.positions[node].is_finite()) {
                return Err(Fault::NonFinite(node));
            }
            if speed > self.speed_max {
                return Err(Fault::TooFast { node, speed });
            }
        }
        Ok(())
    }
}

/// `scale · n nᵀ` by columns.
#[inline]
fn outer(n: DVec3, scale: f64) -> [[f64; 3]; 3] {
    [(n * (scale * n.x)).to_array(), (n * (scale * n.y)).to_array(), (n * (scale * n.z)).to_array()]
}

#[inline]
fn right_of(right: &mut [f64], node: usize) -> &mut [f64] {
    &mut right[3 * node..3 * node + 3]
}

#[inline]
fn add_right(right: &mut [f64], node: usize, force: DVec3) {
    let right = right_of(right, node);
    right[0] += force.x;
    right[1] += force.y;
    right[2] += force.z;
}

#[cfg(test)]
mod tests;
