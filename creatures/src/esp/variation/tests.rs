use super::*;
use crate::esp::genotype::Genotype;
use crate::esp::syllabus::SkillId;
use crate::esp::syllabus::tests::ten_skills;
use crate::random::stream;

#[test]
fn measure() {
    let syllabus = ten_skills().check().unwrap();
    let mut reasons = std::collections::BTreeMap::<&str, usize>::new();
    let mut parts = std::collections::BTreeMap::<usize, usize>::new();
    let start = std::time::Instant::now();
    let founders: Vec<Genotype> = (0..200)
        .map(|i| {
            let child = Genotype::founder(SkillId(0), &syllabus, &mut stream(1, [0, 0, i], "f"));
            for r in &child.refused {
                *reasons.entry(r.name()).or_default() += 1;
            }
            *parts.entry(child.genotype.body.develop().unwrap().parts.len()).or_default() += 1;
            child.genotype
        })
        .collect();
    let mass: f64 = founders.iter().map(|f| f.body.develop().unwrap().mass()).sum::<f64>() / 200.0;
    println!("founders {reasons:?} parts {parts:?} mass {mass} {:?}", start.elapsed());
    let start = std::time::Instant::now();
    for (name, which) in [("mutate", 0), ("crossover", 1), ("graft", 2)] {
        let mut reasons = std::collections::BTreeMap::<&str, usize>::new();
        let mut gave_up = 0;
        for i in 0..1000u32 {
            let mut draws = stream(2, [0, which, i], "m");
            let (a, b) = (&founders[i as usize % 200], &founders[(i as usize * 7 + 3) % 200]);
            let child = match which {
                0 => a.mutate(Scope::Everything, &syllabus, &mut draws),
                1 => a.crossover(b, Scope::Everything, &syllabus, &mut draws),
                _ => a.graft(b, Scope::Everything, &syllabus, &mut draws),
            };
            child.genotype.check(&syllabus).unwrap();
            gave_up += usize::from(child.refused.len() == REDRAWS + 1);
            for r in &child.refused {
                *reasons.entry(r.name()).or_default() += 1;
            }
        }
        println!("{name}: gave up {gave_up} {reasons:?} {:?}", start.elapsed());
    }
}
