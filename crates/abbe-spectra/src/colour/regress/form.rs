//! The forms in which converters return colours, and a colour in several forms.

use crate::colour::adaptation::{AdaptationTransform, adapt};
use crate::colour::coordinates::{from_lab, lab};
use crate::colour::matrix::apply;
use crate::colour::space::RgbSpace;
use crate::colour::tristimulus::Xyz;
use crate::spectrum::Observer;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// A form in which a colour is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColourForm {
    /// XYZ of the CIE 1931 observer.
    Xyz,
    /// Linear sRGB, neither adapted nor clipped.
    LinearSrgb,
    /// Linear sRGB clipped to 0–1 and encoded.
    Srgb,
    /// Linear Display P3, neither adapted nor clipped.
    LinearDisplayP3,
    /// Linear Display P3 clipped to 0–1 and encoded.
    DisplayP3,
    /// Linear Rec. 2020, neither adapted nor clipped.
    LinearRec2020,
    /// Linear Rec. 2020 clipped to 0–1 and encoded.
    Rec2020,
    /// ACEScg, adapted from D65 to the white of ACES by Bradford's transform, and not clipped.
    AcesCg,
    /// XYZ of the CIE 1964 observer.
    XyzCie1964,
    /// XYZ of the observer of CIE 170-2:2015 for 2°.
    XyzCie2015Of2,
    /// XYZ of the observer of CIE 170-2:2015 for 10°.
    XyzCie2015Of10,
    /// CIE 1976 L*, a*, b*, with the light as the white.
    Lab,
    /// XYZ, adapted from the light to D65 by Bradford's transform.
    XyzBradford,
    /// XYZ, adapted from the light to D65 by CAT16 with complete adaptation.
    XyzCat16,
}

/// The kind of values of a form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormKind {
    Xyz,
    Linear(RgbSpace),
    Encoded(RgbSpace),
    Lab,
}

impl ColourForm {
    /// Every form. Those that follow from another one come later.
    pub const ALL: [Self; 14] = [
        Self::Xyz,
        Self::LinearSrgb,
        Self::Srgb,
        Self::LinearDisplayP3,
        Self::DisplayP3,
        Self::LinearRec2020,
        Self::Rec2020,
        Self::AcesCg,
        Self::XyzCie1964,
        Self::XyzCie2015Of2,
        Self::XyzCie2015Of10,
        Self::Lab,
        Self::XyzBradford,
        Self::XyzCat16,
    ];

    /// Returns the key of the form in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Xyz => "xyz",
            Self::LinearSrgb => "linear_srgb",
            Self::Srgb => "srgb",
            Self::LinearDisplayP3 => "linear_display_p3",
            Self::DisplayP3 => "display_p3",
            Self::LinearRec2020 => "linear_rec2020",
            Self::Rec2020 => "rec2020",
            Self::AcesCg => "acescg",
            Self::XyzCie1964 => "xyz_cie1964",
            Self::XyzCie2015Of2 => "xyz_cie2015_2",
            Self::XyzCie2015Of10 => "xyz_cie2015_10",
            Self::Lab => "lab",
            Self::XyzBradford => "xyz_bradford",
            Self::XyzCat16 => "xyz_cat16",
        }
    }

    /// Returns the names of the components: the columns of the form in CSV.
    pub fn columns(self) -> [String; 3] {
        // The first set has shorter names than the others.
        let start = if self == Self::LinearSrgb { "linear" } else { self.name() };
        let start = if self == Self::Xyz { String::new() } else { format!("{}_", start.trim_start_matches("xyz_")) };
        self.letters().map(|letter| format!("{start}{letter}"))
    }

    pub(super) fn letters(self) -> [&'static str; 3] {
        match self.kind() {
            FormKind::Xyz => ["X", "Y", "Z"],
            FormKind::Linear(_) | FormKind::Encoded(_) => ["r", "g", "b"],
            FormKind::Lab => ["L", "a", "b"],
        }
    }

    pub(super) fn kind(self) -> FormKind {
        match self {
            Self::Xyz
            | Self::XyzCie1964
            | Self::XyzCie2015Of2
            | Self::XyzCie2015Of10
            | Self::XyzBradford
            | Self::XyzCat16 => FormKind::Xyz,
            Self::LinearSrgb => FormKind::Linear(RgbSpace::Srgb),
            Self::Srgb => FormKind::Encoded(RgbSpace::Srgb),
            Self::LinearDisplayP3 => FormKind::Linear(RgbSpace::DisplayP3),
            Self::DisplayP3 => FormKind::Encoded(RgbSpace::DisplayP3),
            Self::LinearRec2020 => FormKind::Linear(RgbSpace::Rec2020),
            Self::Rec2020 => FormKind::Encoded(RgbSpace::Rec2020),
            Self::AcesCg => FormKind::Linear(RgbSpace::AcesCg),
            Self::Lab => FormKind::Lab,
        }
    }

    /// Returns the observer whose XYZ the form needs.
    pub(super) fn observer(self) -> &'static Observer {
        let others = [
            (Self::XyzCie1964, Observer::cie1964 as fn() -> &'static Observer),
            (Self::XyzCie2015Of2, Observer::cie2015_2),
            (Self::XyzCie2015Of10, Observer::cie2015_10),
        ];
        others.iter().find(|(form, _)| *form == self).map_or_else(Observer::cie1931, |(_, observer)| observer())
    }

    fn adaptation(self) -> Option<AdaptationTransform> {
        let transforms =
            [(Self::XyzBradford, AdaptationTransform::Bradford), (Self::XyzCat16, AdaptationTransform::Cat16)];
        transforms.into_iter().find_map(|(form, transform)| (form == self).then_some(transform))
    }

    /// Returns the value of white: 100 for XYZ and Lab, and 1 for RGB.
    pub(super) fn white(self) -> f64 {
        match self.kind() {
            FormKind::Xyz | FormKind::Lab => 100.0,
            FormKind::Linear(_) | FormKind::Encoded(_) => 1.0,
        }
    }

    /// Converts XYZ of the form's [`observer`](Self::observer) under a light with the XYZ `white`.
    /// Both are scaled such that the light has Y = 100.
    pub(super) fn of_xyz(self, xyz: Xyz, white: Xyz) -> [f64; 3] {
        let adapted = match self.adaptation() {
            Some(transform) => adapt(xyz, white, d65(), transform),
            None => xyz,
        };
        self.of_adapted_xyz(adapted, white)
    }

    /// Converts XYZ that need no adaptation.
    pub(super) fn of_adapted_xyz(self, xyz: Xyz, white: Xyz) -> [f64; 3] {
        match self.kind() {
            FormKind::Xyz => xyz,
            FormKind::Linear(space) => linear(space, xyz),
            FormKind::Encoded(space) => encoded(space, linear(space, xyz)),
            FormKind::Lab => lab(xyz, white),
        }
    }

    /// Returns CIE 1976 Lab for colour differences. The white is D65, except for [`Self::Lab`].
    pub(super) fn lab(self, colour: [f64; 3]) -> [f64; 3] {
        let of_linear = |space: RgbSpace, rgb: [f64; 3]| {
            let xyz = space.to_xyz(rgb).map(|value| 100.0 * value);
            adapt(xyz, space.white(), d65(), AdaptationTransform::Bradford)
        };
        let xyz = match self.kind() {
            FormKind::Xyz => colour,
            FormKind::Linear(RgbSpace::AcesCg) => of_linear(RgbSpace::AcesCg, colour),
            FormKind::Linear(space) => space.to_xyz(colour).map(|value| 100.0 * value),
            FormKind::Encoded(space) => {
                space.to_xyz(colour.map(|signal| space.decode(signal))).map(|value| 100.0 * value)
            }
            FormKind::Lab => return colour,
        };
        lab(xyz, d65())
    }

    /// Returns linear sRGB for a swatch that shows the colour. A Lab colour is shown in D65.
    pub fn linear_srgb(self, colour: [f64; 3]) -> [f64; 3] {
        RgbSpace::Srgb.from_xyz(from_lab(self.lab(colour), d65()).map(|value| value / 100.0))
    }

    /// Returns the largest difference of a component, relative to white or to the largest component
    /// of the expected colour.
    pub(super) fn largest_difference(self, found: [f64; 3], expected: [f64; 3]) -> f64 {
        let scale = self.scale(expected);
        found.iter().zip(expected).map(|(found, expected)| (found - expected).abs() / scale).fold(0.0, f64::max)
    }

    /// Returns the unit of differences: white, or the largest component if it is larger.
    pub(super) fn scale(self, expected: [f64; 3]) -> f64 {
        expected.iter().fold(self.white(), |scale, value| scale.max(value.abs()))
    }
}

/// Returns the XYZ of D65 with Y = 100.
pub(super) fn d65() -> Xyz {
    RgbSpace::Srgb.white().map(|value| 100.0 * value)
}

/// Returns the linear components of XYZ with Y = 100 for white.
pub(super) fn linear(space: RgbSpace, xyz: Xyz) -> [f64; 3] {
    apply(&space.picture_matrix(), xyz.map(|value| value / 100.0))
}

/// Clips linear components to 0–1 and encodes them.
pub(super) fn encoded(space: RgbSpace, linear: [f64; 3]) -> [f64; 3] {
    linear.map(|component| space.encode(component.clamp(0.0, 1.0)))
}

/// A colour in some of the forms, each with three components.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FormColours([Option<[f64; 3]>; ColourForm::ALL.len()]);

impl FormColours {
    /// Returns the colour in a form, or `None` if it is not given.
    pub fn get(&self, form: ColourForm) -> Option<[f64; 3]> {
        self.0[form as usize]
    }

    /// Returns the given forms with their colours.
    pub fn iter(&self) -> impl Iterator<Item = (ColourForm, [f64; 3])> + '_ {
        ColourForm::ALL.into_iter().filter_map(|form| Some((form, self.get(form)?)))
    }
}

impl FromIterator<(ColourForm, [f64; 3])> for FormColours {
    fn from_iter<I: IntoIterator<Item = (ColourForm, [f64; 3])>>(colours: I) -> Self {
        let mut all = Self::default();
        colours.into_iter().for_each(|(form, colour)| all.0[form as usize] = Some(colour));
        all
    }
}

/// A map from the names of the forms to their colours.
impl Serialize for FormColours {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (form, colour) in self.iter() {
            map.serialize_entry(form.name(), &colour)?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_has_its_place_and_its_columns() {
        let mut columns: Vec<String> = ColourForm::ALL.iter().flat_map(|form| form.columns()).collect();
        assert_eq!(columns[..9], ["X", "Y", "Z", "linear_r", "linear_g", "linear_b", "srgb_r", "srgb_g", "srgb_b"]);
        assert_eq!(columns[24..27], ["cie1964_X", "cie1964_Y", "cie1964_Z"]);
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), 3 * ColourForm::ALL.len());
        assert!(ColourForm::ALL.iter().enumerate().all(|(place, form)| *form as usize == place));
    }

    #[test]
    fn a_form_has_the_colour_of_its_xyz() {
        let xyz = [20.0, 30.0, 25.0];
        for form in ColourForm::ALL.into_iter().filter(|form| *form != ColourForm::Lab) {
            let (known, found) = (lab(xyz, d65()), form.lab(form.of_xyz(xyz, d65())));
            assert!(known.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-9), "{form:?} {known:?} {found:?}");
        }
    }
}
