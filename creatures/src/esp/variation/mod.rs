//! How ESP creatures vary: founders, mutation, crossover and grafting of body and brain (E-37..E-42, E-61, E-63,
//! E-65). It selects nobody, touches nothing that a stage keeps closed, and gives legal creatures alone.

pub mod body;
pub mod brain;
mod breeding;
mod draw;
mod scope;

pub use breeding::{Child, REDRAWS};
pub use scope::Scope;

#[cfg(test)]
mod tests;
