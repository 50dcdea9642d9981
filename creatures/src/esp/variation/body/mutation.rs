//! Mutation of a body's graph: one event of the rows "skeleton" and "muscles, receptors" of E-41.

use super::founder::STRENGTH;
use crate::esp::body::Body;
use crate::esp::body::genotype::{
    Edge, GAP, Joint, MUSCLES_MAX, Muscle, RECEPTORS_MAX, RECURSION, Receptor, SCALE, SEGMENTS_MAX, Segment,
    TRAVEL,
};
use crate::esp::syllabus::{Growth, SkillId};
use crate::esp::variation::Scope;
use crate::esp::variation::draw::{pick, stir, turn, turn_direction};
use crate::random::Stream;
use std::ops::RangeInclusive;

/// Receptors with which a creature starts a skill that may grow them.
const FIRST_EYES: RangeInclusive<usize> = 1..=2;

/// The kinds of event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// Moves one length of one segment.
    Dimensions,
    /// Gives one segment another shape of about its size.
    ShapeKind,
    /// Turns where an edge leaves the parent, where it enters the child, or how the child is turned.
    Attachment,
    /// Moves the scale of one edge.
    Scale,
    /// Gives one edge another kind of joint.
    JointKind,
    /// Turns the axis of one joint, or moves its gap or travel.
    JointPlay,
    /// Adds 1 to one recursion limit, or takes 1 away.
    RecursionLimit,
    /// Toggles whether an edge is of the end of a chain alone.
    Terminal,
    /// Toggles whether an edge mirrors its child.
    Reflect,
    /// Toggles whether an edge makes two copies.
    Symmetric,
    /// Adds a random segment on a random edge.
    AddSegment,
    /// Adds a random edge between any two segments, or from one to itself.
    AddEdge,
    /// Gives one edge another child.
    RedirectEdge,
    /// Removes an edge, and what hung on it alone.
    RemoveEdge,
    /// Adds a random muscle to an edge whose joint moves.
    AddMuscle,
    /// Removes a muscle.
    RemoveMuscle,
    /// Turns one end of a muscle, or moves its strength.
    ChangeMuscle,
    /// Adds a random receptor.
    AddReceptor,
    /// Removes a receptor.
    RemoveReceptor,
    /// Turns a receptor.
    ChangeReceptor,
}

impl Operator {
    /// Every operator with its weight.
    pub(super) const WEIGHTS: [(Operator, f64); 20] = [
        (Operator::Dimensions, 6.0),
        (Operator::ShapeKind, 1.0),
        (Operator::Attachment, 6.0),
        (Operator::Scale, 2.0),
        (Operator::JointKind, 2.0),
        (Operator::JointPlay, 3.0),
        (Operator::RecursionLimit, 1.0),
        (Operator::Terminal, 1.0),
        (Operator::Reflect, 1.0),
        (Operator::Symmetric, 1.0),
        (Operator::AddSegment, 2.0),
        (Operator::AddEdge, 1.5),
        (Operator::RedirectEdge, 0.5),
        (Operator::RemoveEdge, 1.5),
        (Operator::AddMuscle, 3.0),
        (Operator::RemoveMuscle, 1.0),
        (Operator::ChangeMuscle, 4.0),
        (Operator::AddReceptor, 1.0),
        (Operator::RemoveReceptor, 0.5),
        (Operator::ChangeReceptor, 1.5),
    ];

    /// The names of all.
    pub fn names() -> impl Iterator<Item = &'static str> {
        Operator::WEIGHTS.into_iter().map(|(operator, _)| operator.name())
    }

    /// Its name in the lineage.
    pub fn name(self) -> &'static str {
        match self {
            Operator::Dimensions => "dimensions",
            Operator::ShapeKind => "shape_kind",
            Operator::Attachment => "attachment",
            Operator::Scale => "scale",
            Operator::JointKind => "joint_kind",
            Operator::JointPlay => "joint_play",
            Operator::RecursionLimit => "recursion_limit",
            Operator::Terminal => "terminal",
            Operator::Reflect => "reflect",
            Operator::Symmetric => "symmetric",
            Operator::AddSegment => "add_segment",
            Operator::AddEdge => "add_edge",
            Operator::RedirectEdge => "redirect_edge",
            Operator::RemoveEdge => "remove_edge",
            Operator::AddMuscle => "add_muscle",
            Operator::RemoveMuscle => "remove_muscle",
            Operator::ChangeMuscle => "change_muscle",
            Operator::AddReceptor => "add_receptor",
            Operator::RemoveReceptor => "remove_receptor",
            Operator::ChangeReceptor => "change_receptor",
        }
    }

    /// Whether the scope opens what it changes, and there is some of it.
    fn is_legal(self, body: &Body, scope: Scope) -> bool {
        let closed = |locked: bool| locked && !scope.opens_skeleton();
        let muscles = || body.edges.iter().flat_map(|edge| &edge.muscles).any(|gene| !closed(gene.locked));
        let receptors =
            || body.segments.iter().flat_map(|gene| &gene.receptors).any(|gene| !closed(gene.locked));
        let (skeleton, edges) = (scope.opens_skeleton(), !body.edges.is_empty());
        match self {
            Operator::Dimensions | Operator::ShapeKind | Operator::RecursionLimit => skeleton,
            Operator::Attachment
            | Operator::Scale
            | Operator::JointKind
            | Operator::JointPlay
            | Operator::Terminal
            | Operator::Reflect
            | Operator::Symmetric
            | Operator::RemoveEdge => skeleton && edges,
            Operator::RedirectEdge => skeleton && edges && body.segments.len() > 1,
            Operator::AddSegment => {
                skeleton && body.segments.len() < SEGMENTS_MAX && !body.segments_with_room().is_empty()
            }
            Operator::AddEdge => skeleton && !body.segments_with_room().is_empty(),
            Operator::AddMuscle => scope.opens(Growth::Muscles) && body.edges.iter().any(takes_muscle),
            Operator::RemoveMuscle | Operator::ChangeMuscle => scope.opens(Growth::Muscles) && muscles(),
            Operator::AddReceptor => {
                scope.opens(Growth::Photoreceptors) && body.segments.iter().any(takes_receptor)
            }
            Operator::RemoveReceptor | Operator::ChangeReceptor => {
                scope.opens(Growth::Photoreceptors) && receptors()
            }
        }
    }

    fn apply(self, body: &mut Body, scope: Scope, skill: SkillId, stream: &mut Stream) {
        match self {
            Operator::Dimensions => {
                let (length, legal) = pick(any_segment(body, stream).shape.lengths_mut(), stream);
                stir(length, legal, stream);
            }
            Operator::ShapeKind => {
                let segment = any_segment(body, stream);
                segment.shape = segment.shape.kin()[stream.below(2)];
            }
            Operator::RecursionLimit => {
                let segment = any_segment(body, stream);
                let limit = segment.recursion_limit;
                let grows = limit == *RECURSION.start() || limit < *RECURSION.end() && stream.chance(0.5);
                segment.recursion_limit = if grows { limit + 1 } else { limit - 1 };
            }
            Operator::AddSegment => {
                let from = pick(body.segments_with_room(), stream);
                let to = body.random_segment(stream);
                body.add_edge(from, to, skill, stream);
            }
            Operator::AddEdge => {
                let from = pick(body.segments_with_room(), stream);
                let to = any_segment(body, stream).id;
                body.add_edge(from, to, skill, stream);
            }
            Operator::RedirectEdge => {
                let place = stream.below(body.edges.len());
                let others =
                    body.segments.iter().map(|gene| gene.id).filter(|&id| id != body.edges[place].to);
                body.edges[place].to = pick(others.collect(), stream);
            }
            Operator::RemoveEdge => drop(body.edges.remove(stream.below(body.edges.len()))),
            Operator::AddMuscle => {
                let muscle = body.random_muscle(skill, stream);
                let edges = body.edges.iter_mut().filter(|edge| takes_muscle(edge));
                pick(edges.collect(), stream).muscles.push(muscle);
            }
            Operator::AddReceptor => {
                let receptor = body.random_receptor(skill, stream);
                let segments = body.segments.iter_mut().filter(|gene| takes_receptor(gene));
                pick(segments.collect(), stream).receptors.push(receptor);
            }
            Operator::RemoveMuscle => {
                let gone = pick(open_muscles(body, scope), stream).id;
                body.edges.iter_mut().for_each(|edge| edge.muscles.retain(|gene| gene.id != gone));
            }
            Operator::RemoveReceptor => {
                let gone = pick(open_receptors(body, scope), stream).id;
                body.segments.iter_mut().for_each(|gene| gene.receptors.retain(|gene| gene.id != gone));
            }
            Operator::ChangeMuscle => change_muscle(pick(open_muscles(body, scope), stream), stream),
            Operator::ChangeReceptor => {
                turn_direction(&mut pick(open_receptors(body, scope), stream).direction, stream);
            }
            of_edge => {
                let place = stream.below(body.edges.len());
                of_edge.change_edge(&mut body.edges[place], stream);
            }
        }
    }

    /// The operators that change one edge in place.
    fn change_edge(self, edge: &mut Edge, stream: &mut Stream) {
        match self {
            Operator::Attachment => match stream.below(3) {
                0 => turn_direction(&mut edge.parent_dir, stream),
                1 => turn_direction(&mut edge.child_dir, stream),
                _ => edge.orientation = (turn(stream) * edge.orientation).normalize(),
            },
            Operator::Scale => stir(&mut edge.scale, SCALE, stream),
            Operator::JointKind => {
                let others = Joint::ALL.into_iter().filter(|&kind| kind != edge.joint);
                edge.joint = pick(others.collect(), stream);
            }
            Operator::JointPlay => match stream.below(3) {
                0 => turn_direction(&mut edge.axis, stream),
                1 => stir(&mut edge.gap, GAP, stream),
                _ => stir(&mut edge.travel, TRAVEL, stream),
            },
            Operator::Terminal => edge.terminal_only ^= true,
            Operator::Reflect => edge.reflect ^= true,
            Operator::Symmetric => edge.symmetric ^= true,
            other => unreachable!("{other:?} is applied to the body"),
        }
    }
}

impl Body {
    /// One mutation within a scope, drawn by weight among those that it allows, and its name; new genes belong to
    /// a skill. None if nothing may be changed.
    pub fn mutate(&mut self, scope: Scope, skill: SkillId, stream: &mut Stream) -> Option<&'static str> {
        let legal = Operator::WEIGHTS.into_iter().filter(|(operator, _)| operator.is_legal(self, scope));
        let legal: Vec<(Operator, f64)> = legal.collect();
        let mut draw = stream.unit() * legal.iter().map(|(_, weight)| weight).sum::<f64>();
        let drawn = legal.iter().find(|(_, weight)| {
            draw -= weight;
            draw < 0.0
        });
        let (operator, _) = *drawn.or(legal.last())?;
        operator.apply(self, scope, skill, stream);
        self.delete_unreachable();
        Some(operator.name())
    }

    /// One or two random receptors for a skill that begins, as far as there is room, and the names of these events.
    pub(in crate::esp::variation) fn add_eyes(
        &mut self,
        scope: Scope,
        skill: SkillId,
        stream: &mut Stream,
    ) -> Vec<&'static str> {
        let mut added = Vec::new();
        for _ in 0..stream.within(*FIRST_EYES.start(), *FIRST_EYES.end()) {
            if Operator::AddReceptor.is_legal(self, scope) {
                Operator::AddReceptor.apply(self, scope, skill, stream);
                added.push(Operator::AddReceptor.name());
            }
        }
        added
    }
}

fn any_segment<'a>(body: &'a mut Body, stream: &mut Stream) -> &'a mut Segment {
    let place = stream.below(body.segments.len());
    &mut body.segments[place]
}

/// At a joint that does not move a muscle would do nothing.
fn takes_muscle(edge: &Edge) -> bool {
    edge.joint != Joint::Fixed && edge.muscles.len() < MUSCLES_MAX
}

fn takes_receptor(segment: &Segment) -> bool {
    segment.receptors.len() < RECEPTORS_MAX
}

fn open_muscles<'a>(body: &'a mut Body, scope: Scope) -> Vec<&'a mut Muscle> {
    let muscles = body.edges.iter_mut().flat_map(|edge| &mut edge.muscles);
    muscles.filter(|gene| scope.opens_skeleton() || !gene.locked).collect()
}

fn open_receptors<'a>(body: &'a mut Body, scope: Scope) -> Vec<&'a mut Receptor> {
    let receptors = body.segments.iter_mut().flat_map(|gene| &mut gene.receptors);
    receptors.filter(|gene| scope.opens_skeleton() || !gene.locked).collect()
}

fn change_muscle(muscle: &mut Muscle, stream: &mut Stream) {
    match stream.below(3) {
        0 => turn_direction(&mut muscle.parent_dir, stream),
        1 => turn_direction(&mut muscle.child_dir, stream),
        _ => stir(&mut muscle.strength, STRENGTH, stream),
    }
}
