//! ICC profiles of RGB spaces, for programs that cannot read the code points in the `cICP` chunk of
//! a PNG. The tests generate the files of `profiles/`, so that builds need no library for ICC.

use abbe_spectra::colour::RgbSpace;

/// Returns the bytes of the ICC profile of a colour space.
pub(super) fn profile(space: RgbSpace) -> &'static [u8] {
    match space {
        RgbSpace::Srgb => include_bytes!("profiles/srgb.icc"),
        RgbSpace::DisplayP3 => include_bytes!("profiles/display_p3.icc"),
        RgbSpace::Rec2020 => include_bytes!("profiles/rec2020.icc"),
        RgbSpace::AcesCg => include_bytes!("profiles/aces_cg.icc"),
    }
}

/// Returns the name of the file of a profile below `profiles/`.
#[cfg(test)]
pub(super) fn file_name(space: RgbSpace) -> &'static str {
    match space {
        RgbSpace::Srgb => "srgb.icc",
        RgbSpace::DisplayP3 => "display_p3.icc",
        RgbSpace::Rec2020 => "rec2020.icc",
        RgbSpace::AcesCg => "aces_cg.icc",
    }
}
