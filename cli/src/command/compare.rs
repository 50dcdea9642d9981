//! `hatchery compare`: reads cells from the lineage's views and prints what `crate::compare` makes of them.

use std::collections::BTreeSet;

use anyhow::anyhow;

use crate::arguments::Compare;
use crate::compare::{cells, curves, overlay, plot, report, text};
use crate::connect::{Cells as Row, Connection, Source};
use crate::exit::Failure;
use crate::render::{Output, whole};

pub(super) async fn compare(arguments: Compare, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let mut views = [Vec::new(), Vec::new(), Vec::new()];
    let mut seen = BTreeSet::new();
    for reference in &arguments.experiments {
        let experiments = connection.view("v_experiments", Some(reference)).await?.collect().await?;
        let reference = whole_matrix(reference, &experiments)?;
        for (view, rows) in ["v_experiments", "v_stages", "v_generations"].into_iter().zip(&mut views) {
            for row in connection.view(view, Some(&reference)).await?.collect().await? {
                // An experiment may be named twice, by itself and as a cell.
                if !seen.contains(&row.count("experiment")?) {
                    rows.push(row);
                }
            }
        }
        for row in &views[0] {
            seen.insert(row.count("experiment")?);
        }
    }
    let [experiments, stages, generations] = views;
    let report = report::report(&cells::cells(&experiments, &stages, &generations)?);
    if output.json {
        output.document(&report)?;
    } else {
        output.line(text::text(&report))?;
    }
    if let Some(path) = &arguments.csv {
        let mut csv = Vec::new();
        curves::write_csv(&report.curves, &mut csv).map_err(anyhow::Error::new)?;
        whole::write(path, &csv)?;
    }
    if let Some(folder) = &arguments.plot {
        let panels = plot::draw(&report.curves, folder)?;
        let together = overlay::draw(&report.curves, folder)?;
        for path in panels.into_iter().chain(together) {
            if !output.json {
                output.line(format!("drawn: {}", path.display()))?;
            }
        }
    }
    if report.complete {
        Ok(())
    } else {
        // What is missing stands in the report already.
        Err(anyhow!("the table is not complete").into())
    }
}

/// `last` is one experiment; when that is a cell, the comparison is of its matrix.
fn whole_matrix(reference: &str, experiments: &[Row]) -> Result<String, Failure> {
    match experiments {
        [one] if reference == "last" && !one.text("group")?.is_empty() => Ok(one.text("group")?.to_owned()),
        _ => Ok(reference.to_owned()),
    }
}
