//! From one event to the next: which surface a ray meets, in which body of glass it travels, and how it scatters there.

mod encounter;
pub mod ledger;
mod scatter;
mod sink;
mod tally;

pub use encounter::{Encounter, Start, next};
pub use scatter::{Scattered, draw_consistently, scatter};
pub use sink::Sink;
pub use tally::Tally;
