//! Names of channels.

pub(super) const XYZ: [&str; 3] = ["xyz.X", "xyz.Y", "xyz.Z"];

pub(super) const NOISE: &str = "error.noise";

pub(super) const BIAS: &str = "error.bias";

/// The channel that marks pixels near an edge of the illumination.
pub(super) const EDGE: &str = "error.edge";

pub(super) const DENOISED_XYZ: [&str; 3] = ["denoised.X", "denoised.Y", "denoised.Z"];

pub(super) const DENOISED_RGB: [&str; 3] = ["denoised.R", "denoised.G", "denoised.B"];

pub(super) const DENOISED_NOISE: &str = "denoised.noise";

pub(super) const DENOISED_BIAS: &str = "denoised.bias";

/// The names of the channels of layers begin with one of these prefixes.
pub(super) const LAYER_PREFIXES: [&str; 11] = [
    "albedo.",
    "normal.",
    "depth.",
    "uv.",
    "samples",
    "path.",
    "light.",
    "stokes.",
    "polarisation.",
    "CryptoObject",
    "CryptoMaterial",
];

/// The names of the channels that contain exact sums begin with this prefix.
pub(super) const SUMS_PREFIX: &str = "sums.";
