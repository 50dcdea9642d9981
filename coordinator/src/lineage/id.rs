//! Names of rows, each a type of its own. They say nothing of places: those are the search's.

use std::fmt;

macro_rules! row_id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u64);

        impl $name {
            /// As SQLite's 64-bit signed integer.
            pub(crate) fn sql(self) -> i64 {
                self.0.cast_signed()
            }

            /// From a column that holds such an id.
            pub(crate) fn of(column: i64) -> Self {
                $name(column.cast_unsigned())
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.fmt(f)
            }
        }
    };
}

row_id! {
    /// An experiment: the number that people type.
    ExperimentId
}
row_id! {
    /// One stage of one run of an experiment.
    StageId
}
row_id! {
    /// An individual, in the whole file; never renumbered, never used again. Those of a generation are
    /// contiguous in order of index.
    IndividualId
}

impl IndividualId {
    /// The individual `index` places on, in a generation that starts with this one.
    pub fn at(self, index: u32) -> Self {
        IndividualId(self.0 + u64::from(index))
    }
}
