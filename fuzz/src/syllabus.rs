//! Syllabus tables of ESP experiments, and the formulas within them.

use crate::text;
use creatures::esp::fitness::{Fitness, Formula};
use creatures::esp::syllabus::SyllabusTable;

/// A fitness formula. What is read prints as a formula that means the same.
pub fn expression(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    if let Ok(formula) = Formula::try_from(text.to_owned()) {
        let quantities = formula.quantities();
        let again = Formula::try_from(String::from(formula)).expect("its text is a formula");
        assert_eq!(again.quantities(), quantities);
    }
}

/// The JSON text of a syllabus, or of one fitness within it. What is accepted has an order of stages.
pub fn syllabus(bytes: &[u8]) {
    let Some(text) = text(bytes) else { return };
    let Ok(value) = serde_json::from_str::<serde_json::Value>(text) else { return };
    // May be refused; may not panic.
    let _ = Fitness::read(&value);
    let Ok(table) = serde_json::from_value::<SyllabusTable>(value) else { return };
    if let Ok(syllabus) = table.check() {
        assert_eq!(syllabus.skills().len(), table.skill.len());
        for id in syllabus.ids() {
            let skill = syllabus.skill(id).expect("an id of this syllabus");
            assert_eq!(syllabus.find(skill.name()), Some(id));
        }
    }
}
