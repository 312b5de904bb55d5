//! From one event to the next: which surface a ray meets, in which body of glass it travels, and how it scatters there.

mod encounter;
pub mod ledger;
mod tally;
mod scatter;
mod sink;

pub use encounter::{Encounter, Leg, Start, next};
pub use scatter::{Scattered, draw_consistently, scatter};
pub use sink::Sink;
pub use tally::Tally;
