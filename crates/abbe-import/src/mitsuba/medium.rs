//! Converts the participating media of a Mitsuba scene.

use super::transform::{affine, steps};
use super::{
    properties::Properties, reader::MitsubaReader, spectrum::MitsubaSpectrum, volume::VolumeGrid, xml::XmlElement,
};
use abbe_spectra::error::Result;
use serde_json::{Value, json};
use std::rc::Rc;

/// A property that may vary in space.
enum MitsubaVolume {
    /// The same value everywhere, or in the transformed unit cube of a heterogeneous medium.
    Constant {
        value: MitsubaSpectrum,
        transform: Vec<Value>,
    },
    Grid {
        grid: VolumeGrid,
        transform: Vec<Value>,
    },
}

impl From<MitsubaSpectrum> for MitsubaVolume {
    fn from(value: MitsubaSpectrum) -> Self {
        Self::Constant { value, transform: Vec::new() }
    }
}

impl MitsubaReader<'_> {
    /// Converts a medium and returns its name. Returns `None` if the medium is left out.
    pub(super) fn medium(&mut self, medium: &Rc<XmlElement>) -> Result<Option<String>> {
        let key = Rc::as_ptr(medium);
        if let Some((_, name)) = self.media.iter().find(|(known, _)| *known == key) {
            return Ok(name.clone());
        }
        let properties = Properties::new(medium);
        let name = match medium.plugin() {
            "homogeneous" | "heterogeneous" => {
                let converted = self.coefficients(&properties)?;
                self.note_unread(&properties);
                converted.map(|value| self.scene.add_medium(medium.title(), value))
            }
            other => {
                self.note(medium, format!("a medium of the type \"{other}\" is not supported and is left out"));
                None
            }
        };
        self.media.push((key, name.clone()));
        Ok(name)
    }

    fn coefficients(&mut self, properties: &Properties) -> Result<Option<Value>> {
        properties.ignore(&["has_spectral_extinction", "sample_emitters", "method"]);
        let scale = properties.number("scale", 1.0)?;
        let phase = self.phase(properties)?;
        let [absorbed, scattered] = ["sigma_a", "sigma_s"].map(|name| self.constant_volume(properties, name));
        if let (Some(absorbed), Some(scattered)) = (absorbed?, scattered?) {
            let [absorption, scattering] = [absorbed, scattered].map(|it| it.map(|value| scale * value).coefficient());
            let medium = json!({"absorption": absorption, "scattering": scattering, "phase": phase});
            return Ok(Some(json!({"homogeneous": medium})));
        }
        let albedo = self.constant_volume(properties, "albedo")?.unwrap_or(MitsubaSpectrum::Number(0.75));
        let extinction = self.volume(properties, "sigma_t")?;
        let extinction = extinction.unwrap_or(MitsubaSpectrum::Number(1.0).into());
        let density = match &extinction {
            MitsubaVolume::Constant { value, .. } => value.map(|value| scale * value),
            MitsubaVolume::Grid { .. } => MitsubaSpectrum::Number(scale),
        };
        let scattering = density.combined(&albedo, |density, albedo| density * albedo.clamp(0.0, 1.0));
        let absorption = density.combined(&albedo, |density, albedo| density * (1.0 - albedo.clamp(0.0, 1.0)));
        let mut medium = json!({
            "absorption": absorption.coefficient(), "scattering": scattering.coefficient(), "phase": phase
        });
        let transform = match extinction {
            MitsubaVolume::Constant { .. } if properties.element.plugin() == "homogeneous" => {
                return Ok(Some(json!({"homogeneous": medium})));
            }
            MitsubaVolume::Constant { transform, .. } => {
                (medium["bounds"], medium["density"]) = (json!([[0, 0, 0], [1, 1, 1]]), json!({"constant": 1}));
                transform
            }
            MitsubaVolume::Grid { grid, transform } => {
                if grid.values.iter().all(|&value| value <= 0.0) {
                    return Ok(None);
                }
                medium["bounds"] = json!(grid.bounds);
                medium["density"] = json!({"values": grid.values, "resolution": grid.resolution});
                transform
            }
        };
        if !transform.is_empty() {
            medium["transform"] = json!(transform);
        }
        Ok(Some(json!({"grid": medium})))
    }

    /// Reads a property that is the same everywhere. A grid is replaced by its mean.
    fn constant_volume(&mut self, properties: &Properties, name: &str) -> Result<Option<MitsubaSpectrum>> {
        Ok(match self.volume(properties, name)? {
            None => None,
            Some(MitsubaVolume::Constant { value, .. }) => Some(value),
            Some(MitsubaVolume::Grid { grid, .. }) => {
                self.note(properties.element, format!("the grid of \"{name}\" is replaced by its mean"));
                Some(MitsubaSpectrum::Number(grid.mean()))
            }
        })
    }

    fn volume(&mut self, properties: &Properties, name: &str) -> Result<Option<MitsubaVolume>> {
        let Some(element) = properties.find(name) else { return Ok(None) };
        let element = self.document.resolve(element);
        if element.tag != "volume" {
            return Ok(Some(self.spectrum(&element)?.into()));
        }
        let inner = Properties::new(&element);
        let volume = match element.plugin() {
            "constvolume" => {
                let value = inner.find("value").map(|value| self.document.resolve(value));
                let value = value.map(|value| self.spectrum(&value)).transpose()?;
                let transform = steps(affine(&element, inner.transform("to_world")?)?);
                MitsubaVolume::Constant { value: value.unwrap_or(MitsubaSpectrum::Number(1.0)), transform }
            }
            "gridvolume" => self.grid(&inner)?,
            other => {
                self.note(&element, format!("a volume of the type \"{other}\" is not supported and becomes 1"));
                return Ok(Some(MitsubaSpectrum::Number(1.0).into()));
            }
        };
        self.note_unread(&inner);
        Ok(Some(volume))
    }

    /// Reads a grid from a `.vol` file. A large grid or one with colours is replaced by its mean.
    fn grid(&mut self, properties: &Properties) -> Result<MitsubaVolume> {
        let element = properties.element;
        properties.ignore(&["raw", "accel"]);
        let (_, path) = self.document.file(element, properties.required_text("filename")?)?;
        let mut grid = VolumeGrid::read(&path).map_err(|error| element.locate(error))?;
        if !properties.boolean("use_grid_bbox", false)? {
            grid.bounds = [[0.0; 3], [1.0; 3]];
        }
        if properties.text("wrap_mode")?.is_some_and(|mode| mode != "clamp")
            || properties.text("filter_type")?.is_some_and(|filter| filter != "trilinear")
        {
            let what = "`wrap_mode` and `filter_type` of a grid are left out: the grid is linear, and 0 outside";
            self.note(element, what);
        }
        let to_world = affine(element, properties.transform("to_world")?)?;
        if let Some(reason) = grid.unusable() {
            self.note(element, format!("{reason} and is replaced by its mean"));
            return Ok(MitsubaSpectrum::Number(grid.mean()).into());
        }
        Ok(MitsubaVolume::Grid { grid, transform: steps(to_world) })
    }

    fn phase(&mut self, properties: &Properties) -> Result<Value> {
        let Some(element) = self.tagged(properties, "phase").pop() else { return Ok(json!("isotropic")) };
        let inner = Properties::new(&element);
        let phase = match element.plugin() {
            "isotropic" => json!("isotropic"),
            "rayleigh" => json!("rayleigh"),
            "hg" => json!({"henyey_greenstein": {"g": inner.number("g", 0.8)?}}),
            other => {
                let what = format!("a phase function of the type \"{other}\" is not supported and becomes isotropic");
                self.note(&element, what);
                return Ok(json!("isotropic"));
            }
        };
        self.note_unread(&inner);
        Ok(phase)
    }
}
