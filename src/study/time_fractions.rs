//! The division of a study's time.

/// The parts of a study, as fractions of its budget without the rehearsals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeFractions {
    /// The trials for the choice of the reference's integrator.
    pub trial: f64,
    pub reference: f64,
    pub photon_curve: f64,
    /// The measurement of error against time for the path tracer.
    pub path_curve: f64,
    pub sweep: f64,
    pub effects: f64,
}

pub const TIME_FRACTIONS: TimeFractions =
    TimeFractions { trial: 0.06, reference: 0.34, photon_curve: 0.14, path_curve: 0.1, sweep: 0.2, effects: 0.16 };
