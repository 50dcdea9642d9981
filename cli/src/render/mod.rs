//! Where answers go: text or JSON on standard output, errors and bars on standard error. It asks nothing.

pub(crate) mod drawing;
pub(crate) mod failure;
pub(crate) mod json;
pub(crate) mod letters;
pub(crate) mod number;
pub(crate) mod progress;
pub(crate) mod table;
pub(crate) mod whole;

use std::io::{IsTerminal, Write};

use serde::Serialize;

use crate::exit::Failure;

/// How and where to a command prints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Output {
    /// JSON instead of text.
    pub(crate) json: bool,
}

impl Output {
    /// True where bars can be drawn: standard error is a terminal, and text is wanted.
    pub(crate) fn has_bars(self) -> bool {
        !self.json && std::io::stderr().is_terminal()
    }

    /// Prints text and ends the line.
    pub(crate) fn line(self, text: impl std::fmt::Display) -> Result<(), Failure> {
        let mut out = std::io::stdout().lock();
        writeln!(out, "{text}")?;
        Ok(out.flush()?)
    }

    /// Prints one JSON value on one line: an object of a stream.
    pub(crate) fn object(self, value: &impl Serialize) -> Result<(), Failure> {
        let text = serde_json::to_string(value).map_err(anyhow::Error::new)?;
        self.line(text)
    }

    /// Prints one JSON document, indented: a whole answer.
    pub(crate) fn document(self, value: &impl Serialize) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(value).map_err(anyhow::Error::new)?;
        self.line(text)
    }
}
