//! Random materials and media.

use crate::random::Pcg;
use crate::spectra;
use serde_json::{Map, Value, json};

/// The materials and media of a scene. Lengths are relative to `scale`, a length in scene units.
pub(crate) struct Palette {
    /// The materials by name.
    pub(crate) materials: Map<String, Value>,
    /// The media by name.
    pub(crate) media: Map<String, Value>,
    scale: f64,
    /// True if ideally smooth surfaces may occur. The path tracer finds no light from points,
    /// spots and beams by way of such surfaces.
    smooth: bool,
}

/// The places where a material occurs.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Use {
    /// The closed surface of a body.
    Body,
    /// A flat surface.
    Sheet,
    /// A wall or floor.
    Wall,
}

impl Palette {
    pub(crate) fn new(scale: f64, smooth: bool) -> Self {
        Self { materials: Map::new(), media: Map::new(), scale, smooth }
    }

    /// Adds a material and returns its name.
    pub(crate) fn add(&mut self, material: Value) -> String {
        let name = format!("material{}", self.materials.len());
        self.materials.insert(name.clone(), material);
        name
    }

    fn roughness(&self, rng: &mut Pcg) -> f64 {
        if self.smooth && rng.chance(0.6) { 0.0 } else { rng.between(0.15, 0.8) }
    }

    /// Adds a random material and returns its name. `size` is the size of the object.
    pub(crate) fn surface(&mut self, rng: &mut Pcg, used: Use, size: f64) -> String {
        let material = match (used, rng.below(20)) {
            (Use::Wall, 0..17) | (_, 0..5) => json!({ "diffuse": { "reflectance": spectra::reflectance(rng, 0.8) } }),
            (Use::Wall, _) | (_, 5 | 6) => {
                json!({ "glossy": { "reflectance": spectra::reflectance(rng, 0.7), "ior": spectra::index(rng), "roughness": self.roughness(rng) } })
            }
            (_, 7 | 8) => {
                let metal = rng.pick(&["Ag", "Au", "Cu", "Al", "Fe", "Cr"]);
                let roughness = self.roughness(rng);
                if rng.chance(0.7) {
                    json!({ "conductor": { "metal": metal, "roughness": roughness } })
                } else {
                    json!({ "conductor": { "eta": rng.between(0.2, 2.0), "k": rng.between(1.0, 5.0), "roughness": roughness } })
                }
            }
            (_, 9) => {
                json!({ "translucent": { "reflectance": spectra::reflectance(rng, 0.45), "transmittance": rng.between(0.05, 0.2) } })
            }
            (_, 10) => self.mix(rng),
            (_, 11) => json!("absorber"),
            (_, 12) if self.smooth => json!({ "mirror": { "reflectance": spectra::reflectance(rng, 0.95) } }),
            (_, 13) if self.smooth => self.pane(rng, size),
            (Use::Sheet, _) if self.smooth => self.pane(rng, size),
            (Use::Sheet, _) => {
                json!({ "translucent": { "reflectance": 0.15, "transmittance": spectra::reflectance(rng, 0.6) } })
            }
            (Use::Body, _) => return self.glass(rng, size, 0),
        };
        self.add(material)
    }

    fn mix(&mut self, rng: &mut Pcg) -> Value {
        let mut parts = vec![
            json!({ "diffuse": { "reflectance": spectra::reflectance(rng, 0.8) } }),
            json!({ "conductor": { "metal": rng.pick(&["Au", "Al", "Cu"]), "roughness": rng.between(0.2, 0.6) } }),
        ];
        if self.smooth && rng.chance(0.5) {
            parts.push(json!({ "mirror": { "reflectance": 0.8 } }));
        }
        let parts: Vec<Value> = parts
            .into_iter()
            .map(|part| json!({ "material": self.add(part), "weight": rng.between(0.3, 1.0) }))
            .collect();
        json!({ "mix": parts })
    }

    fn pane(&self, rng: &mut Pcg, size: f64) -> Value {
        let mut pane = json!({ "ior": spectra::index(rng) });
        if rng.chance(0.5) {
            let thickness = 0.02 * size;
            pane["thickness"] = json!(thickness * self.scale);
            pane["absorption"] = absorption(rng, thickness * self.scale);
        }
        json!({ "thin_dielectric": pane })
    }

    /// Adds a glass or a liquid, perhaps with absorption or a medium. Returns its name.
    pub(crate) fn glass(&mut self, rng: &mut Pcg, size: f64, priority: i32) -> String {
        let mut glass = json!({ "ior": spectra::index(rng), "roughness": self.roughness(rng), "priority": priority });
        match rng.below(6) {
            0 | 1 => glass["absorption"] = absorption(rng, size * self.scale),
            2 => glass["medium"] = json!(self.homogeneous(rng, size, priority)),
            _ => {}
        }
        self.add(json!({ "dielectric": glass }))
    }

    /// Adds the boundary of a medium and returns its name.
    pub(crate) fn boundary(&mut self, medium: &str) -> String {
        self.add(json!({ "boundary": { "medium": medium } }))
    }

    fn phase(rng: &mut Pcg) -> Value {
        match rng.below(8) {
            0 | 1 => json!("isotropic"),
            2 => json!("rayleigh"),
            3 => json!({ "mie": { "radius_um": rng.log_between(0.05, 1.0), "spread": 1.3 } }),
            4 => {
                json!({ "henyey_greenstein": { "g": { "table": { "nm": [360, 830], "values": [rng.between(-0.3, 0.7), rng.between(-0.3, 0.7)] } } } })
            }
            _ => json!({ "henyey_greenstein": { "g": rng.between(-0.5, 0.8) } }),
        }
    }

    fn add_medium(&mut self, medium: Value) -> String {
        let name = format!("medium{}", self.media.len());
        self.media.insert(name.clone(), medium);
        name
    }

    /// Adds a homogeneous medium and returns its name. `size` is the size of its body.
    pub(crate) fn homogeneous(&mut self, rng: &mut Pcg, size: f64, priority: i32) -> String {
        let [scattering, absorption, phase] = self.coefficients(rng, size);
        self.add_medium(json!({ "homogeneous": {
            "scattering": scattering, "absorption": absorption, "phase": phase, "priority": priority
        } }))
    }

    fn coefficients(&self, rng: &mut Pcg, size: f64) -> [Value; 3] {
        let depth = rng.log_between(0.1, 5.0) / (size * self.scale);
        let albedo = rng.pick(&[1.0, 0.9, 0.7, 0.3, 0.0]);
        let scattering = spectra::coefficient(rng, depth * albedo);
        let absorption = spectra::coefficient(rng, depth * (1.0 - albedo));
        [scattering, absorption, Self::phase(rng)]
    }

    /// Adds a medium of varying density in a box with this size, centred at the origin. Returns its
    /// name.
    pub(crate) fn grid(&mut self, rng: &mut Pcg, size: [f64; 3], placement: (&Value, &Value)) -> String {
        let half = size.map(|side| 0.5 * side * self.scale);
        let least = half.into_iter().fold(f64::INFINITY, f64::min);
        let density = match rng.below(5) {
            0 => json!({ "constant": rng.between(0.5, 1.5) }),
            1 => json!({ "exponential": { "value": 2, "scale_height": least * rng.between(0.3, 2.0) } }),
            2 => {
                json!({ "sphere": { "value": 1.5, "center": [0, 0, 0], "radius": least, "falloff": rng.between(0.0, 1.0) } })
            }
            3 => {
                json!({ "noise": { "value": 3, "scale": least, "octaves": 2, "threshold": 0.2, "seed": rng.below(1000) } })
            }
            _ => {
                let values: Vec<f64> =
                    (0..27).map(|_| if rng.chance(0.3) { 0.0 } else { rng.between(0.1, 2.0) }).collect();
                json!({ "values": values, "resolution": [3, 3, 3] })
            }
        };
        let [scattering, absorption, phase] = self.coefficients(rng, size[0]);
        self.add_medium(json!({ "grid": {
            "bounds": [half.map(|x| -x), half], "density": density, "scattering": scattering, "absorption": absorption,
            "phase": phase, "transform": placement.0, "motion": placement.1
        } }))
    }

    /// Adds a glowing medium and returns its name. `power` is in W.
    pub(crate) fn glowing(&mut self, rng: &mut Pcg, size: f64, power: f64, radiance: f64) -> String {
        let [mut scattering, mut absorption, phase] = self.coefficients(rng, size);
        if absorption == json!(0.0) || !absorption.is_number() {
            absorption = json!(0.5 / (size * self.scale));
        }
        if rng.chance(0.6) {
            scattering = json!(0);
        }
        let spectrum = spectra::light(rng);
        let emission = match rng.below(2) {
            0 => json!({ "spectrum": spectrum, "power": power }),
            _ => json!({ "spectrum": spectrum, "radiance": radiance }),
        };
        self.add_medium(json!({ "homogeneous": {
            "scattering": scattering, "absorption": absorption, "phase": phase, "emission": emission
        } }))
    }
}

/// Returns the absorption coefficient of a body of this size in scene units.
fn absorption(rng: &mut Pcg, size: f64) -> Value {
    let depth = rng.log_between(0.1, 4.0);
    spectra::coefficient(rng, depth / size)
}
