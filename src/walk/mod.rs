//! From one event to the next: which surface a ray meets, in which body of glass it travels, and how it scatters there.

mod encounter;
pub mod ledger;
mod passage;
mod scatter;
mod sink;
mod stretch;
mod tally;

pub use encounter::{Encounter, Leg, Start, next, next_in_air, travel};
pub use passage::{Passage, Passages, bias_of_excess, excess_depth, passages, passages_tracked, product as passes};
pub use scatter::{Drawn, Scattered, draw_consistently, scatter, scatter_together};
pub use sink::Sink;
pub use stretch::{Stretch, stretches};
pub use tally::Tally;
