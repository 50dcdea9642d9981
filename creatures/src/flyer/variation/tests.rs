//! What each operator does and keeps (F-11, F-62..F-65, T-21).
