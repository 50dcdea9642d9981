use super::*;

const PROBE: &str = "name = \"load\"\nsystem = \"probe\"\n[search]\nkind = \"probe\"\n";

#[test]
fn a_resolved_file_is_a_file_of_the_same_experiment() {
    let experiment = Experiment::parse(PROBE, &Overrides::default()).unwrap().remove(0);
    println!("{}", experiment.resolved());
    let again = Experiment::parse_resolved(&experiment.resolved()).unwrap();
    assert_eq!(again.resolved(), experiment.resolved());
    assert_eq!(again.digest(), experiment.digest());
}
