//! One round's linear algebra: every body's velocity from the momenta, exactly and in O(n). It takes the
//! pieces of the laws as given and decides nothing.
//!
//! Body i obeys `A V = P + Λ − Σ Λ_children`: inertia `A`, twist `V`, free momentum `P`, joint impulse `Λ`.
//! A joint says `V = V_parent + b + Σ s y`: bias `b` (locked components), free directions `s` with rates `y`
//! under known impulses `sᵀΛ = τ`. Eliminating y leaves `Λ = A′ V_parent − P′` with
//! `A′ = A − A s sᵀA / (sᵀA s)` and `P′ = P − A b − A s (τ + sᵀ(P − A b)) / (sᵀA s)`, which joins the
//! parent. So the locked components, which a solver of constraint rows works hardest on, cost nothing here,
//! and a free one costs a rank-one update.

use super::World;
use super::contact::Footing;
use super::spatial::Six;
use super::staircase::Demand;

/// An inertia that is not positive, at the body that hangs on the joint, or at the root.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Singular {
    pub(super) body: usize,
}

impl World {
    /// Starts a round: every body's own inertia and momentum, and the contacts upon it.
    pub(super) fn load(&mut self, footing: Option<&Footing>) {
        for body in &mut self.bodies {
            (body.carried, body.impetus) = (body.inertia, body.momentum);
        }
        let Some(footing) = footing else { return };
        for contact in &self.contacts {
            let body = &mut self.bodies[contact.body];
            contact.load(footing, &mut body.carried, &mut body.impetus);
        }
    }

    /// Leaf to root: what a parent feels of everything that hangs on it.
    pub(super) fn eliminate(&mut self) -> Result<(), Singular> {
        for child in (1..self.bodies.len()).rev() {
            let link = &mut self.links[child - 1];
            let (parents, rest) = self.bodies.split_at_mut(child);
            let mut inertia = rest[0].carried;
            let mut momentum = rest[0].impetus;
            let mut bias = link.bias;
            for dof in link.dofs() {
                if let Demand::Locked(rate) = dof.demand() {
                    bias.add_scaled(&dof.direction, rate);
                }
            }
            momentum.add_scaled(&inertia.times(&bias), -1.0);
            link.offset = bias;
            for dof in link.dofs_mut() {
                let Demand::Free(impulse) = dof.demand() else { continue };
                dof.momentum = inertia.times(&dof.direction);
                let pivot = dof.direction.dot(&dof.momentum);
                if pivot.is_nan() || pivot <= 0.0 {
                    return Err(Singular { body: child });
                }
                dof.need = inertia.transposed_times(&dof.direction);
                dof.mobility = 1.0 / pivot;
                dof.drift = (impulse + dof.direction.dot(&momentum)) * dof.mobility;
                inertia.add_outer(&dof.momentum, &dof.need, -dof.mobility);
                momentum.add_scaled(&dof.momentum, -dof.drift);
            }
            let parent = &mut parents[link.parent];
            parent.carried.add(&inertia);
            parent.impetus.add_scaled(&momentum, 1.0);
        }
        Ok(())
    }

    /// Root to leaf: every twist, and the rate of every free direction.
    pub(super) fn substitute(&mut self) -> Result<(), Singular> {
        let root = &mut self.bodies[0];
        root.twist = if self.fixture {
            Six::ZERO
        } else {
            root.carried.solve(&root.impetus).ok_or(Singular { body: 0 })?
        };
        for child in 1..self.bodies.len() {
            let link = &mut self.links[child - 1];
            let mut twist = self.bodies[link.parent].twist;
            for dof in link.dofs_mut().iter_mut().rev() {
                if let Demand::Free(_) = dof.demand() {
                    dof.rate = dof.drift - dof.mobility * dof.need.dot(&twist);
                    twist.add_scaled(&dof.direction, dof.rate);
                }
            }
            twist.add_scaled(&link.offset, 1.0);
            self.bodies[child].twist = twist;
        }
        Ok(())
    }
}
