//! Failures on standard error: problems of an experiment file drawn into its text on a terminal, one line
//! each otherwise, with file, line and column in both. With `--json`, one object. It sets no exit code.

use std::io::{IsTerminal, Write};
use std::path::Path;

use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, LabeledSpan, NamedSource, Severity, SourceCode,
};
use proto::v1;
use serde_json::json;

use super::json;
use crate::exit::Failure;

/// Tells why a command failed.
pub(crate) fn report(failure: &Failure, as_json: bool) {
    let terminal = std::io::stderr().is_terminal();
    let text = match failure {
        _ if as_json => object(failure).to_string(),
        Failure::Problems { file, text, problems } if terminal => {
            let colour = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
            drawn(file, text, problems, colour)
        }
        Failure::Problems { file, problems, .. } => lines(file, problems),
        Failure::Failed(error) => format!("error: {error:#}"),
        other => format!("error: {other}"),
    };
    // Whoever closed standard error does not want to know.
    let _ = writeln!(std::io::stderr().lock(), "{}", text.trim_end());
}

fn object(failure: &Failure) -> serde_json::Value {
    let message = match failure {
        Failure::Failed(error) => format!("{error:#}"),
        other => other.to_string(),
    };
    let mut error = json!({ "kind": failure.kind(), "message": message });
    if let Failure::Problems { file, problems, .. } = failure {
        error["file"] = json!(file.display().to_string());
        error["problems"] = problems.iter().map(json::problem).collect();
    }
    json!({ "error": error })
}

/// One line a problem: `file:line:column: message (help)`.
pub(crate) fn lines(file: &Path, problems: &[v1::Problem]) -> String {
    let line = |problem: &v1::Problem| {
        let place = match (problem.line, problem.column) {
            (0, _) => format!("{}", file.display()),
            (line, column) => format!("{}:{line}:{column}", file.display()),
        };
        let help = if problem.help.is_empty() { String::new() } else { format!(" ({})", problem.help) };
        format!("{place}: error: {}{help}", message(problem))
    };
    problems.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The message, with its key in front unless it names it already.
fn message(problem: &v1::Problem) -> String {
    if problem.key.is_empty() || problem.message.contains(&format!("`{}`", problem.key)) {
        problem.message.clone()
    } else {
        format!("`{}`: {}", problem.key, problem.message)
    }
}

/// Every problem drawn into the text of the file.
fn drawn(file: &Path, text: &str, problems: &[v1::Problem], colour: bool) -> String {
    let theme = if colour { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme);
    let source = NamedSource::new(file.display().to_string(), text.to_owned());
    problems
        .iter()
        .map(|problem| {
            let shown = Shown { source: &source, problem };
            // The handler writes into a string and so cannot fail; its line is there if it ever does.
            let mut drawn = String::new();
            match handler.render_report(&mut drawn, &shown) {
                Ok(()) => drawn,
                Err(_) => lines(file, std::slice::from_ref(problem)),
            }
        })
        .collect()
}

#[derive(Debug)]
struct Shown<'a> {
    source: &'a NamedSource<String>,
    problem: &'a v1::Problem,
}

impl Shown<'_> {
    /// The span, within the text: what the other side sent may be of another text.
    fn span(&self) -> Option<std::ops::Range<usize>> {
        let size = self.source.inner().len() as u64;
        let start = self.problem.start?;
        let end = self.problem.end.unwrap_or(start).max(start);
        (end <= size).then_some(start as usize..end as usize)
    }
}

impl std::fmt::Display for Shown<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&message(self.problem))
    }
}

impl std::error::Error for Shown<'_> {}

impl Diagnostic for Shown<'_> {
    fn severity(&self) -> Option<Severity> {
        Some(Severity::Error)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        let help = &self.problem.help;
        (!help.is_empty()).then(|| Box::new(help) as Box<dyn std::fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.span().map(|_| self.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.span()?;
        Some(Box::new(std::iter::once(LabeledSpan::underline(span))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"a\"\nsystem = \"walker\"\n[search]\npopulatoin = 80\n";

    fn problems() -> Vec<v1::Problem> {
        let start = TEXT.find("populatoin").unwrap() as u64;
        vec![
            v1::Problem {
                key: "search.populatoin".into(),
                message: "unknown key".into(),
                help: "did you mean `population`?".into(),
                start: Some(start),
                end: Some(start + 10),
                line: 4,
                column: 1,
            },
            v1::Problem {
                key: "task.body".into(),
                message: "`task.body` is missing".into(),
                ..Default::default()
            },
        ]
    }

    #[test]
    fn a_problem_is_one_line_with_its_place_where_there_is_no_terminal() {
        let expected = "walk.toml:4:1: error: `search.populatoin`: unknown key (did you mean `population`?)\n\
                        walk.toml: error: `task.body` is missing";
        assert_eq!(lines(Path::new("walk.toml"), &problems()), expected);
    }

    #[test]
    fn a_problem_is_drawn_into_the_file_on_a_terminal() {
        insta::assert_snapshot!(drawn(Path::new("walk.toml"), TEXT, &problems(), false));
    }

    #[test]
    fn a_span_beyond_the_text_is_left_out_and_does_not_panic() {
        let problem = v1::Problem { start: Some(10_000), end: Some(10_001), ..problems()[0].clone() };
        assert!(drawn(Path::new("walk.toml"), TEXT, &[problem], false).contains("unknown key"));
    }
}
