//! Courtship (A-80..A-84): whom a fish courts, and how far it is. One stage at a time; a fish that loses its
//! partner starts anew.

mod moves;
mod partner;

use crate::fish::habits::Sex;
use crate::fish::perception::{Figure, Senses};
use crate::fish::world::FishId;
use crate::fish::{Chase, Command, Posture};
use crate::math::wrap_angle;
use std::f64::consts::TAU;

/// A stage that lasts longer fails; a partner unseen for longer is lost; either is left alone for so long.
const STAGE_MAX: f64 = 400.0;
const UNSEEN_MAX: f64 = 60.0;
const EXCLUSION: f64 = 100.0;
/// How long a male displays to one who courts another.
const DISPLAY: f64 = 60.0;
/// Touches of the loop that do not yet suffice.
const LOOPS: u32 = 6;
/// Heading change of the female that ends the circle, rad.
const CIRCLE: f64 = 2.0 * TAU;
/// Touches of the abdomen that end the ritual.
const NUZZLES: u32 = 3;
/// Steps of backing off after each.
const BACK_OFF: u32 = 40;
/// How much larger a male has to be to be taken instead, and how near, by L.
const LARGER: f64 = 1.1;
const NEAR: f64 = 1.5;
/// The counter of turns goes on only if asked within so long.
const CONTINUES: f64 = 0.1;

/// How far a courtship is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Stage {
    /// Nobody in sight.
    #[default]
    Search,
    /// After one who does not care yet.
    Follow,
    /// Looping before one who courts another.
    Display,
    /// He loops, she hovers.
    Loop,
    /// Tail by tail.
    Circle,
    /// She rises, he follows.
    Ascend,
    /// He touches her from below.
    Nuzzle,
    /// Mated.
    Done,
}

impl Stage {
    /// From 0 to 6: display counts as following.
    pub fn rank(self) -> u32 {
        match self {
            Stage::Search => 0,
            Stage::Follow | Stage::Display => 1,
            Stage::Loop => 2,
            Stage::Circle => 3,
            Stage::Ascend => 4,
            Stage::Nuzzle => 5,
            Stage::Done => 6,
        }
    }
}

/// The state of one fish's courtship.
#[derive(Debug, Clone, Default)]
pub struct Courtship {
    /// How far it is.
    pub stage: Stage,
    /// With whom.
    pub partner: Option<FishId>,
    /// The farthest stage ever.
    pub best: Stage,
    /// When the stage began.
    since: f64,
    /// When the partner was last seen, and how it looked.
    seen: f64,
    last: Option<Figure>,
    counts: Counts,
    /// Height at which the ascent began.
    height: f64,
    /// Partners left alone until a time.
    excluded: Vec<(FishId, f64)>,
}

/// What moves a courtship on.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Counts {
    /// Touches of the loop's point.
    touches: u32,
    /// Whether he is at the point, and has to leave it before he touches again.
    touching: bool,
    /// Steps that he has stood still before her without touching it.
    waited: u32,
    /// Her change of heading, rad, left positive.
    turned: f64,
    /// Time and heading when last asked.
    heading: Option<(f64, f64)>,
    /// Touches of the abdomen.
    nuzzles: u32,
    /// Steps left of backing off.
    backing: u32,
}

impl Counts {
    /// He is so far from the loop's point, by L; whether he has touched it often enough.
    fn touch(&mut self, distance: f64) -> bool {
        if distance <= moves::TOUCH && !self.touching {
            (self.touching, self.waited) = (true, 0);
            self.touches += 1;
        } else if distance > moves::REARM {
            self.touching = false;
        }
        self.touches > LOOPS
    }

    /// She heads there at a time; whether she has turned often enough.
    fn turn(&mut self, time: f64, heading: f64) -> bool {
        if let Some((before, last)) = self.heading
            && time - before < CONTINUES
        {
            self.turned += wrap_angle(heading - last);
        }
        self.heading = Some((time, heading));
        self.turned.abs() >= CIRCLE
    }

    /// He has touched the abdomen; whether that was the last time.
    fn nuzzle(&mut self) -> bool {
        self.nuzzles += 1;
        self.backing = BACK_OFF;
        self.nuzzles >= NUZZLES
    }
}

impl Courtship {
    /// Room for leaving so many partners alone.
    pub fn make_room(&mut self, partners: usize) {
        self.excluded.reserve(partners);
    }

    /// Back to searching; those left alone stay so.
    pub fn reset(&mut self) {
        *self = Courtship {
            best: self.best,
            excluded: std::mem::take(&mut self.excluded),
            ..Courtship::default()
        };
    }

    /// Gives the partner up for a while.
    fn give_up(&mut self, time: f64) {
        if let Some(partner) = self.partner {
            self.excluded.push((partner, time + EXCLUSION));
        }
        self.reset();
    }

    /// One step; what to do, or none if there is nobody to court.
    pub fn court(
        &mut self,
        senses: &Senses<'_>,
        chase: &mut Chase,
        posture: &Posture<'_>,
    ) -> Option<Command> {
        let time = senses.scene.time;
        self.excluded.retain(|&(_, until)| until > time);
        self.look(senses);
        if self.stage <= Stage::Follow {
            self.choose(senses);
        }
        self.advance(senses);
        let partner = self.last.clone().filter(|_| self.partner.is_some())?;
        let command = moves::Dancer { senses, partner: &partner, chase, posture }.command(self);
        self.best = self.best.max(self.stage);
        Some(command)
    }

    /// Looks at the partner; one that is dead, lost or tedious is given up.
    fn look(&mut self, senses: &Senses<'_>) {
        let time = senses.scene.time;
        let Some(id) = self.partner else { return };
        if !senses.scene.figures[id.index()].alive {
            self.reset();
            return;
        }
        if let Some(percept) = senses.fish(id) {
            (self.seen, self.last) = (time, Some(percept.figure.clone()));
        }
        // He approaches from where she cannot see: once she rises she trusts that he follows (Choice).
        let trusts = senses.me.sex == Sex::Female && self.stage >= Stage::Ascend;
        if (time - self.seen > UNSEEN_MAX && !trusts) || time - self.since > STAGE_MAX {
            self.give_up(time);
        }
    }

    /// Takes the most desirable partner in sight, if there is none yet or persistence lets it.
    fn choose(&mut self, senses: &Senses<'_>) {
        let time = senses.scene.time;
        let Some(best) = partner::best(senses, &self.excluded) else { return };
        let held = self.partner.and_then(|id| senses.fish(id));
        let change = match held {
            None => true,
            Some(held) => {
                best.figure.id != held.figure.id
                    && crate::fish::perception::focus::replaces(
                        best.distance,
                        held.distance,
                        senses.habits.persistence,
                    )
            }
        };
        if change {
            let (best_stage, excluded) = (self.best, std::mem::take(&mut self.excluded));
            *self = Courtship {
                stage: Stage::Follow,
                partner: Some(best.figure.id),
                best: best_stage,
                since: time,
                seen: time,
                last: Some(best.figure.clone()),
                excluded,
                ..Courtship::default()
            };
        }
    }

    /// Goes on to the next stage as the partner's signals and the counters say (A-82..A-84).
    fn advance(&mut self, senses: &Senses<'_>) {
        let (me, time) = (senses.me, senses.scene.time);
        let male = me.sex == Sex::Male;
        let Some(partner) = &self.last else { return };
        let theirs = partner.partner;
        if theirs.is_some_and(|third| third != me.id) {
            match (male, self.stage) {
                (true, Stage::Display) if time - self.since > DISPLAY => self.give_up(time),
                (true, Stage::Display) => {}
                (true, _) => self.enter(Stage::Display, time),
                (false, _) => self.give_up(time),
            }
            return;
        }
        let mutual = theirs == Some(me.id);
        let stage = partner.stage;
        match self.stage {
            Stage::Search => {}
            Stage::Follow | Stage::Display if mutual => self.enter(Stage::Loop, time),
            Stage::Follow | Stage::Display => {}
            _ if !mutual => self.enter(Stage::Follow, time),
            Stage::Loop if !male => {
                if let Some(rival) = partner::larger(senses, partner, LARGER, NEAR) {
                    let rival = rival.figure.clone();
                    (self.partner, self.seen, self.last) = (Some(rival.id), time, Some(rival));
                    self.enter(Stage::Loop, time);
                } else if stage >= Stage::Circle {
                    self.enter(Stage::Circle, time);
                }
            }
            Stage::Loop if self.counts.touches > LOOPS => self.enter(Stage::Circle, time),
            Stage::Circle if male && stage >= Stage::Ascend => self.enter(Stage::Ascend, time),
            Stage::Circle if !male && self.counts.turned.abs() >= CIRCLE => {
                self.height = me.center.z;
                self.enter(Stage::Ascend, time);
            }
            Stage::Ascend if male && stage >= Stage::Nuzzle => self.enter(Stage::Nuzzle, time),
            Stage::Ascend if !male && self.risen(senses) && is_ready(senses) => {
                self.enter(Stage::Nuzzle, time)
            }
            Stage::Nuzzle if self.counts.nuzzles >= NUZZLES => self.enter(Stage::Done, time),
            _ => {}
        }
    }

    /// Whether she is high enough, or under the surface.
    fn risen(&self, senses: &Senses<'_>) -> bool {
        let (length, z) = (senses.me.length(), senses.me.center.z);
        z - self.height >= moves::RISE * length || senses.scene.tank.surface() - z < length
    }

    fn enter(&mut self, stage: Stage, time: f64) {
        if stage <= Stage::Loop {
            self.counts = Counts::default();
        }
        (self.stage, self.since) = (stage, time);
    }
}

/// Whether a female may stop: she is level, since a hovering fish cannot change its pitch, and has room for a male
/// who comes from any side, since near a wall he avoids it rather than nuzzles (Choice).
fn is_ready(senses: &Senses<'_>) -> bool {
    let (me, scene) = (senses.me, senses.scene);
    let walls = scene.tank.contacts(me.center).into_iter().filter(|contact| contact.normal.z == 0.0);
    let solids = scene.obstacles.iter().map(|solid| solid.contact(me.center));
    me.forward.z.abs() < moves::LEVEL
        && walls.chain(solids).all(|contact| contact.distance >= moves::ROOM * me.length())
}

#[cfg(test)]
mod tests;
