//! The simulated wavelengths.

/// The simulated band of wavelengths in nm, to which all powers and integrals refer.
pub const BAND_NM: (f64, f64) = (360.0, 830.0);

/// The green wavelength, in nm, for the whole band: in decisions of paths without wavelengths, in
/// the size of the Airy disk, and in the optical depth that classifies media.
pub const REFERENCE_NM: f64 = 550.0;

/// The lower end of the ultraviolet, in nm.
pub const ULTRAVIOLET_FROM_NM: f64 = 300.0;
