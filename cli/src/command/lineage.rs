//! `hatchery lineage`: the ancestors of an individual, nearest first, printed as they arrive.

use proto::v1::{Ancestor, AncestryRequest};

use crate::arguments::Lineage;
use crate::connect::{Connection, PATIENT, Source, within};
use crate::exit::Failure;
use crate::render::{Output, json, number};

pub(super) async fn lineage(arguments: Lineage, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let request = AncestryRequest {
        individual: arguments.individual,
        depth: arguments.depth.unwrap_or(0),
        line: arguments.line,
    };
    let mut ancestors = connection.lineage().ancestry(within(PATIENT, request)).await?.into_inner();
    let mut is_founder = true;
    while let Some(ancestor) = ancestors.message().await? {
        if is_founder && !output.json {
            output.line(HEADING)?;
        }
        is_founder = false;
        if output.json {
            output.object(&json::ancestor(&ancestor))?;
        } else {
            output.line(line(&ancestor))?;
        }
    }
    if is_founder && !output.json {
        output.line(format!("individual {} is a founder: it has no parents", arguments.individual))?;
    }
    Ok(())
}

/// Rows are printed as they come, so columns have their widths before the widest is known.
const HEADING: &str = "depth  individual  generation    fitness  status      operator, parents";

fn line(of: &Ancestor) -> String {
    let parents = of.parents.iter().map(|link| link.parent.to_string()).collect::<Vec<_>>().join(" and ");
    let origin =
        if parents.is_empty() { of.operator.clone() } else { format!("{} of {parents}", of.operator) };
    format!(
        "{:>5}  {:>10}  {:>10}  {:>9}  {:<10}  {origin}",
        of.depth,
        of.id,
        of.generation,
        number::figure_or_dash(of.fitness),
        of.status
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use proto::v1::ParentLink;

    #[test]
    fn an_ancestor_says_how_it_was_made_and_of_whom() {
        let parents = vec![
            ParentLink { parent: 9, role: "first".into() },
            ParentLink { parent: 8, role: "second".into() },
        ];
        let child = Ancestor {
            id: 21,
            depth: 1,
            generation: 2,
            operator: "crossover".into(),
            status: "completed".into(),
            fitness: Some(61.25),
            parents,
            ..Default::default()
        };
        assert_eq!(
            line(&child),
            "    1          21           2    61.2500  completed   crossover of 9 and 8"
        );
        let founder = Ancestor { operator: "random".into(), parents: vec![], ..child };
        assert!(line(&founder).ends_with("  random"));
        assert_eq!(
            HEADING.find("operator"),
            line(&founder).find("random"),
            "headings stand over their columns"
        );
    }
}
