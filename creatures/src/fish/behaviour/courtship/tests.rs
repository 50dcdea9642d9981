use super::*;
use crate::fish::Body;
use crate::fish::habits::{Habits, Nature};
use crate::fish::perception::tests::Pond;
use glam::DVec3;

/// T-23
#[test]
fn the_seventh_touch_starts_the_circle() {
    let mut counts = Counts::default();
    for touch in 1..=7 {
        assert_eq!(counts.touch(0.1), touch == 7, "{touch}");
        assert_eq!(counts.touches, touch);
        counts.touch(0.2);
        counts.touch(0.1);
        assert_eq!(counts.touches, touch, "not beyond 0.3 L in between");
        counts.touch(0.31);
    }
}

/// T-23
#[test]
fn two_full_turns_end_the_circle() {
    let enough = |degrees: f64| {
        let mut counts = Counts::default();
        let steps = 1000;
        (0..=steps).any(|step| {
            let share = f64::from(step) / f64::from(steps);
            counts.turn(0.055 * f64::from(step), wrap_angle(-(degrees * share).to_radians()))
        })
    };
    assert!(!enough(719.0) && enough(721.0));
}

/// T-23: a turn made while something else was done does not count, and what was counted stays.
#[test]
fn an_interruption_preserves_the_counters() {
    let mut counts = Counts::default();
    counts.touch(0.1);
    counts.turn(0.0, 0.0);
    counts.turn(0.055, 0.5);
    counts.turn(5.0, 2.0);
    counts.turn(5.055, 2.25);
    counts.nuzzle();
    assert_eq!((counts.touches, counts.turned, counts.nuzzles), (1, 0.75, 1));
}

/// T-23
#[test]
fn the_third_nuzzle_ends_the_ritual() {
    let mut counts = Counts::default();
    assert!(!counts.nuzzle() && !counts.nuzzle() && counts.nuzzle());
    assert_eq!(counts.backing, BACK_OFF);
}

fn pacifist(sex: Sex, size: f64) -> Habits {
    Habits { size, ..Habits::published(Nature::Pacifist, sex) }
}

/// Fish 0 looks at what was added before it.
fn court(pond: &Pond, fish: usize, courtship: &mut Courtship) -> Option<Command> {
    let body = Body::published(pond.habits[fish].size);
    let place = pond.figures[fish].center - Posture::new(&body.rest).center();
    let positions: Vec<DVec3> = body.rest.iter().map(|&node| node + place).collect();
    pond.senses(fish, |senses| courtship.court(senses, &mut Chase::default(), &Posture::new(&positions)))
}

///
#[test]
fn males_choose_the_near_one_and_females_the_large_one() {
    let mut pond = Pond::empty();
    pond.add_of(pacifist(Sex::Male, 1.0), DVec3::ZERO, 0.0);
    pond.add_of(pacifist(Sex::Female, 1.0), DVec3::new(30.0, 100.0, 0.0), std::f64::consts::PI);
    pond.add_of(pacifist(Sex::Female, 2.0), DVec3::new(-30.0, 120.0, 0.0), 0.0);
    pond.add_of(pacifist(Sex::Male, 1.2), DVec3::new(60.0, 20.0, 0.0), 0.0);
    let partner = |fish| {
        let mut courtship = Courtship::default();
        court(&pond, fish, &mut courtship).map(|_| (courtship.stage, courtship.partner))
    };
    assert_eq!(partner(0), Some((Stage::Follow, Some(FishId(1)))));
    assert_eq!(partner(1), Some((Stage::Follow, Some(FishId(3)))));
    let alone = Pond { figures: pond.figures[..1].to_vec(), ..pond };
    assert!(court(&alone, 0, &mut Courtship::default()).is_none(), "AF-11");
}

fn pair() -> Pond {
    let mut pond = Pond::empty();
    pond.add_of(pacifist(Sex::Male, 1.0), DVec3::ZERO, 0.0);
    pond.add_of(pacifist(Sex::Female, 1.0), DVec3::new(0.0, 60.0, 0.0), std::f64::consts::PI);
    pond
}

/// the three cases.
#[test]
fn signals_lead_to_following_displaying_and_looping() {
    let mut pond = pair();
    let mut male = Courtship::default();
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Follow);
    pond.figures[1].partner = Some(FishId(7));
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Display);
    pond.time = 59.0;
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Display);
    let mut chosen = male.clone();
    pond.time = 61.0;
    assert!(court(&pond, 0, &mut male).is_none());
    assert_eq!((male.stage, male.partner), (Stage::Search, None), "he leaves her alone");
    pond.figures[1].partner = Some(FishId(0));
    court(&pond, 0, &mut chosen);
    assert_eq!(chosen.stage, Stage::Loop);
    pond.time = 150.0;
    assert!(court(&pond, 0, &mut male).is_none());
    pond.time = 162.0;
    assert!(court(&pond, 0, &mut male).is_some(), "after 100 time units he tries again");
}

/// a female who is followed by one that courts another looks for another.
#[test]
fn a_female_leaves_a_male_who_courts_another() {
    let mut pond = pair();
    pond.figures[0].partner = Some(FishId(9));
    let mut female = Courtship::default();
    assert!(court(&pond, 1, &mut female).is_none());
    assert_eq!(female.partner, None);
}

/// A-83, AF-14
#[test]
fn a_much_larger_male_who_displays_near_by_is_taken_instead() {
    let mut pond = pair();
    pond.figures[0].partner = Some(FishId(1));
    let mut female = Courtship::default();
    court(&pond, 1, &mut female);
    assert_eq!((female.stage, female.partner), (Stage::Loop, Some(FishId(0))));
    let mut add = |size: f64, y: f64| {
        pond.add_of(pacifist(Sex::Male, size), DVec3::new(10.0, y, 0.0), 0.0);
        let rival = pond.figures.last_mut().unwrap();
        (rival.stage, rival.partner) = (Stage::Display, Some(FishId(1)));
        court(&pond, 1, &mut female);
        female.partner
    };
    assert_eq!(add(1.05, 35.0), Some(FishId(0)), "hardly larger");
    assert_eq!(add(1.5, 0.0), Some(FishId(0)), "far away");
    assert_eq!(add(1.2, 35.0), Some(FishId(4)));
    let mut first = Courtship { stage: Stage::Loop, partner: Some(FishId(1)), ..Courtship::default() };
    pond.figures[1].partner = Some(FishId(4));
    court(&pond, 0, &mut first);
    assert_eq!(first.stage, Stage::Display, "the first male turns to displaying");
}

/// A-81, AF-12
#[test]
fn a_dead_partner_and_a_lost_one_end_it() {
    let mut pond = pair();
    let looping = Courtship { stage: Stage::Loop, partner: Some(FishId(1)), ..Courtship::default() };
    let mut widower = looping.clone();
    pond.figures[1].alive = false;
    assert!(court(&pond, 0, &mut widower).is_none());
    assert_eq!((widower.stage, widower.partner), (Stage::Search, None));
    pond.figures[1].alive = true;
    pond.figures[1].partner = Some(FishId(0));
    let mut tired = looping;
    pond.time = 401.0;
    assert!(court(&pond, 0, &mut tired).is_none(), "400 time units are enough");
    assert_eq!(tired.excluded, [(FishId(1), 501.0)]);
}

/// circle, ascent and nuzzle follow one another as the partner shows them.
#[test]
fn each_follows_the_stage_that_the_other_shows() {
    let mut pond = pair();
    (pond.figures[0].partner, pond.figures[1].partner) = (Some(FishId(1)), Some(FishId(0)));
    let start = |stage| Courtship { stage, partner: Some(FishId(1)), ..Courtship::default() };
    let mut male = start(Stage::Loop);
    male.counts.touches = 7;
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Circle);
    pond.figures[1].stage = Stage::Ascend;
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Ascend);
    pond.figures[1].stage = Stage::Nuzzle;
    court(&pond, 0, &mut male);
    assert_eq!(male.stage, Stage::Nuzzle);
    male.counts.nuzzles = 3;
    court(&pond, 0, &mut male);
    assert_eq!((male.stage, male.best), (Stage::Done, Stage::Done));
    pond.figures[0].stage = Stage::Circle;
    let mut female = Courtship { stage: Stage::Loop, partner: Some(FishId(0)), ..Courtship::default() };
    court(&pond, 1, &mut female);
    assert_eq!(female.stage, Stage::Circle);
    female.counts.turned = -CIRCLE;
    court(&pond, 1, &mut female);
    assert_eq!(female.stage, Stage::Ascend);
    pond.figures[1].center.z += 31.0;
    pond.figures[1].forward = DVec3::new(0.0, -0.8, 0.6);
    court(&pond, 1, &mut female);
    assert_eq!(female.stage, Stage::Ascend, "she levels out first");
    pond.figures[1].forward = DVec3::NEG_Y;
    pond.figures[1].center.x = 165.0;
    court(&pond, 1, &mut female);
    assert_eq!(female.stage, Stage::Ascend, "nor does she stop within two body lengths of a wall");
    pond.figures[1].center.x = 155.0;
    court(&pond, 1, &mut female);
    assert_eq!(female.stage, Stage::Nuzzle);
}

/// A pair side by side along y, his mouth off a point of hers: the loop's centre or her abdomen.
fn pair_at(off: DVec3, stage: Stage) -> Pond {
    let mut pond = Pond::empty();
    pond.add_of(pacifist(Sex::Female, 1.0), DVec3::ZERO, 0.0);
    let her = &pond.figures[0];
    let point = match stage {
        Stage::Loop => her.mouth + DVec3::new(0.0, 20.0, 5.0),
        _ => her.abdomen,
    };
    let mouth = Posture::new(&Body::published(1.0).rest).mouth();
    pond.add_of(pacifist(Sex::Male, 1.0), point + off - mouth, 0.0);
    for (fish, partner) in [(0, 1), (1, 0)] {
        (pond.figures[fish].partner, pond.figures[fish].stage) = (Some(FishId(partner)), stage);
    }
    pond
}

/// he touches from below, backs off until she is ahead of him again, and then comes anew.
#[test]
fn a_touch_from_below_counts_and_is_followed_by_backing_off() {
    let mut male = Courtship { stage: Stage::Nuzzle, partner: Some(FishId(0)), ..Courtship::default() };
    let mut nuzzle = |off| {
        let command = court(&pair_at(off, Stage::Nuzzle), 1, &mut male).unwrap();
        (male.counts.nuzzles, command.stroke > 0.0)
    };
    assert_eq!(nuzzle(DVec3::new(0.0, -2.0, -0.4)), (0, false), "level with it");
    assert_eq!(nuzzle(DVec3::new(0.0, -2.5, -1.8)), (0, false), "3.1 away");
    let below = DVec3::new(0.0, -1.0, -2.0);
    for _ in 0..200 {
        assert_eq!(nuzzle(below), (1, true), "one touch, and off");
    }
    let off = DVec3::new(0.0, -6.5, -2.0);
    assert_eq!(nuzzle(off), (1, true), "the last step of backing off");
    assert_eq!(nuzzle(off), (1, false));
    assert_eq!(nuzzle(below), (2, true));
}

/// who has stopped where the point never passes swims off after one period of it.
#[test]
fn a_male_who_waits_in_vain_comes_anew() {
    // He has his back to her, and goes by how she looked.
    let last = Some(pair_at(DVec3::ZERO, Stage::Loop).figures.remove(0));
    let mut male = Courtship { stage: Stage::Loop, partner: Some(FishId(0)), last, ..Courtship::default() };
    let mut swims = |off| court(&pair_at(off, Stage::Loop), 1, &mut male).unwrap().swim > 0.0;
    let beside = DVec3::new(4.0, 0.0, 0.0);
    for step in 0..218 {
        assert!(!swims(beside), "step {step}");
    }
    assert!(swims(beside) && swims(DVec3::new(21.0, 0.0, 0.0)));
    assert!(!swims(beside), "he has been away");
}
