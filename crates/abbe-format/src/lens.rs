//! The lens of the camera in the scene file.

use crate::forms::{Form, Forms};
use crate::prelude::*;
use crate::{CoatingFile, IndexFile, JsonPath, check, forms};
use abbe_spectra::error::{Error, Result};
use serde::de::MapAccess;

/// The lens that projects the scene onto the sensor.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(title = "Camera lens")]
pub enum LensFile {
    /// An ideal pinhole: everything is in focus.
    #[schemars(example = json!({"pinhole": {"fov": 35}}))]
    Pinhole {
        /// Vertical field of view.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180, "x-unit" = "°"))]
        fov: f64,
    },
    /// An orthographic projection along parallel rays. The rays start on the plane through the
    /// camera that faces the viewing direction. This plane must not pass through glass or a medium.
    #[schemars(example = json!({"orthographic": {"height": 2}}))]
    Orthographic {
        /// Height of the picture.
        #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
        height: f64,
    },
    /// An ideal thin lens with depth of field.
    #[schemars(example = json!({"thin": {"focal_length_mm": 50, "f_number": 2.8, "focus_distance": 4,
        "sensor_height_mm": 24, "blades": 6, "rotation": 15, "diffraction": false}}))]
    #[schemars(example = json!({"thin": {"fov": 35, "focus_distance": 4, "defocus_angle": 0.5}}))]
    Thin(ThinLensFile),
    /// A system of real glass elements. Rays are traced through it at each wavelength.
    #[schemars(example = json!({"system": {"prescription": "double-gauss", "focus_distance": 4, "f_number": 4,
        "sensor_height_mm": 24, "blades": 6, "rotation": 15, "diffraction": false, "transmission": "fresnel",
        "coating": {"layers": [{"ior": "MgF2", "thickness_nm": 100}]}, "ghosts": true}}))]
    System(SystemLensFile),
}

/// A thin lens. Either state `focal_length_mm`, `f_number`, `focus_distance` and
/// `sensor_height_mm`, or state `fov`, `focus_distance` and `defocus_angle`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThinLensFile {
    /// Focal length.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "mm"))]
    pub focal_length_mm: Option<f64>,
    /// Focal length divided by the diameter of the entrance pupil.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub f_number: Option<f64>,
    /// Distance from the lens to the plane that is in focus.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub focus_distance: f64,
    /// Height of the sensor.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "mm"))]
    pub sensor_height_mm: Option<f64>,
    /// Vertical field of view.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub fov: Option<f64>,
    /// Apex angle of the cone from a point in focus to the pupil.
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 180, "x-unit" = "°"))]
    pub defocus_angle: Option<f64>,
    /// Number of blades of a polygonal aperture stop.
    #[schemars(range(min = 3, max = 64), extend("x-default" = "round stop"))]
    pub blades: Option<u32>,
    /// Rotation of the polygonal aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "°"))]
    pub rotation: f64,
    /// True if light is diffracted at the aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub diffraction: bool,
}

/// The two forms of a thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ThinLensForm {
    /// Focal length, f-number and sensor.
    Photographic {
        focal_length_mm: f64,
        f_number: f64,
        /// Distance from the lens to the plane that is in focus, in the scene's unit.
        focus_distance: f64,
        sensor_height_mm: f64,
    },
    /// Field of view and defocus angle.
    Angular { fov: f64, focus_distance: f64, defocus_angle: f64 },
}

/// A lens system.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SystemLensFile {
    /// The surfaces of the lens.
    pub prescription: PrescriptionFile,
    /// Distance of the plane that is in focus.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "scene unit"))]
    pub focus_distance: f64,
    /// f-number to which the lens is stopped down.
    #[schemars(extend("exclusiveMinimum" = 0, "x-default" = "fully open"))]
    pub f_number: Option<f64>,
    /// Height of the sensor.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "mm"))]
    pub sensor_height_mm: f64,
    /// Number of blades of a polygonal aperture stop.
    #[schemars(range(min = 3, max = 64), extend("x-default" = "round stop"))]
    pub blades: Option<u32>,
    /// Rotation of the polygonal aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never", extend("x-unit" = "°"))]
    pub rotation: f64,
    /// True if light is diffracted at the aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub diffraction: bool,
    /// The light that the surfaces transmit.
    #[schemars(extend("x-default" = "fresnel with coatings or ghosts, ideal otherwise"))]
    pub transmission: Option<LensTransmissionFile>,
    /// Thin films on each surface between glass and air that has no coating of its own, from the
    /// air to the glass.
    #[schemars(extend("x-default" = "no coating"))]
    pub coating: Option<CoatingFile>,
    /// True if light that two surfaces of the lens reflect reaches the sensor.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub ghosts: bool,
}

/// The light that the surfaces of a lens system transmit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(title = "Transmission of a lens")]
pub enum LensTransmissionFile {
    /// All light.
    Ideal,
    /// The transmittance of each surface, from Fresnel's equations or from its coating.
    Fresnel,
}

/// A lens prescription: the name of a built-in prescription, the path of a file (JSON, Zemax
/// `.zmx`, CODE V `.seq`, OSLO `.len` or Optical Bench `.txt`), or a list of surfaces. `abbe lens
/// --list` prints the built-in names.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "PrescriptionFile", title = "Prescription", transform = crate::schema::or_name)]
#[schemars(example = &"double-gauss", example = &"lenses/singlet.json")]
pub enum PrescriptionFile {
    /// The name of a built-in prescription, or a path relative to the scene's folder.
    #[serde(skip)]
    Name(String),
    /// The surfaces, from the scene to the sensor. At most one of them is the aperture stop.
    #[schemars(example = json!({"surfaces": [{"radius_mm": 60, "thickness_mm": 6, "ior": "N-BK7",
        "semi_aperture_mm": 20}, {"radius_mm": -60, "thickness_mm": 56, "ior": 1, "semi_aperture_mm": 20,
        "stop": true}]}))]
    Surfaces(#[schemars(length(min = 1))] Vec<LensSurfaceFile>),
}

impl Forms for PrescriptionFile {
    const EXPECTED: &'static str = "a name, a path, or an object with the key surfaces";

    fn from_name(name: String) -> Option<Self> {
        Some(Self::Name(name))
    }

    fn from_object<'de, A: MapAccess<'de>>(form: Form<A>) -> std::result::Result<Self, A::Error> {
        Self::deserialize(form)
    }
}

impl<'de> Deserialize<'de> for PrescriptionFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        forms::deserialize(deserializer)
    }
}

impl Serialize for PrescriptionFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        if let Self::Name(name) = self { serializer.serialize_str(name) } else { Self::serialize(self, serializer) }
    }
}

/// One surface of a lens prescription.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Lens surface", example = json!({"radius_mm": 60, "conic": -0.2, "aspheric": [1e-9],
    "thickness_mm": 6, "ior": "N-BK7", "semi_aperture_mm": 20, "stop": false, "coating": {"layers": [{"ior": "MgF2",
    "thickness_nm": 100}]}}))]
pub struct LensSurfaceFile {
    /// Radius of curvature, positive if the centre of curvature lies towards the sensor. 0 or null
    /// is a plane. The magnitude must be at least `semi_aperture_mm`, unless `conic` is stated.
    #[serde(deserialize_with = "forms::deserialize_radius")]
    #[schemars(schema_with = "crate::schema::radius_or_plane", extend("x-unit" = "mm"))]
    pub radius_mm: f64,
    /// Conic constant: 0 is a sphere, −1 a paraboloid.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub conic: f64,
    /// Coefficients of h⁴, h⁶, … that an even asphere adds to the sag of the conic, where h is the
    /// distance from the axis in mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(skip_serializing_if = "crate::schema::never", length(max = 8), extend("x-unit" = "mm⁻³, mm⁻⁵, …"))]
    pub aspheric: Vec<f64>,
    /// Distance to the next surface along the axis.
    #[schemars(range(min = 0), extend("x-unit" = "mm"))]
    pub thickness_mm: f64,
    /// Index of refraction after the surface, relative to air. 1 is air.
    #[schemars(extend("minimum" = 1))]
    pub ior: IndexFile,
    /// Half the clear diameter.
    #[schemars(extend("exclusiveMinimum" = 0, "x-unit" = "mm"))]
    pub semi_aperture_mm: f64,
    /// True if this surface is the aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    #[schemars(skip_serializing_if = "crate::schema::never")]
    pub stop: bool,
    /// Thin films on the surface, from the air to the glass. Between two glasses, from the scene to
    /// the sensor.
    #[schemars(extend("x-default" = "the coating of the lens"))]
    pub coating: Option<CoatingFile>,
}

impl LensFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Pinhole { fov } => check::between(&at.key("pinhole").key("fov"), *fov, 0.0, 180.0),
            Self::Orthographic { height } => check::positive(&at.key("orthographic").key("height"), *height),
            Self::Thin(lens) => lens.validate(&at.key("thin")),
            Self::System(lens) => lens.validate(&at.key("system")),
        }
    }
}

fn validate_blades(at: &JsonPath, blades: Option<u32>) -> Result<()> {
    blades.map_or(Ok(()), |blades| check::count(&at.key("blades"), u64::from(blades), 3, 64))
}

impl ThinLensFile {
    /// Returns the form of the lens, or an error if keys are missing or belong to both forms.
    pub fn form(&self) -> Result<ThinLensForm> {
        self.form_at(&JsonPath::Root)
    }

    /// Returns the form in which the file describes the lens at the path `at`.
    fn form_at(&self, at: &JsonPath) -> Result<ThinLensForm> {
        const EXPECTED: &str =
            "either focal_length_mm, f_number, focus_distance, sensor_height_mm or fov, focus_distance, defocus_angle";
        let focus_distance = self.focus_distance;
        let photographic = [
            ("focal_length_mm", self.focal_length_mm),
            ("f_number", self.f_number),
            ("sensor_height_mm", self.sensor_height_mm),
        ];
        let angular = [("fov", self.fov), ("defocus_angle", self.defocus_angle)];
        let first = |keys: &[(&'static str, Option<f64>)]| Some(keys.iter().find(|(_, it)| it.is_some())?.0);
        let missing = |keys: &[(&'static str, Option<f64>)]| -> Error {
            let key = keys.iter().find(|(_, it)| it.is_none()).map_or("", |(key, _)| *key);
            check::fault(at, format!("missing key \"{key}\""), EXPECTED)
        };
        match (first(&photographic), first(&angular)) {
            (Some(a), Some(b)) => Err(check::fault(&at.key(b), format!("found together with `{a}`"), EXPECTED)),
            (None, None) => Err(check::fault(at, "found neither `focal_length_mm` nor `fov`", EXPECTED)),
            (Some(_), None) => match (self.focal_length_mm, self.f_number, self.sensor_height_mm) {
                (Some(focal_length_mm), Some(f_number), Some(sensor_height_mm)) => {
                    Ok(ThinLensForm::Photographic { focal_length_mm, f_number, focus_distance, sensor_height_mm })
                }
                (..) => Err(missing(&photographic)),
            },
            (None, Some(_)) => match (self.fov, self.defocus_angle) {
                (Some(fov), Some(defocus_angle)) => Ok(ThinLensForm::Angular { fov, focus_distance, defocus_angle }),
                (..) => Err(missing(&angular)),
            },
        }
    }

    fn validate(&self, at: &JsonPath) -> Result<()> {
        let form = self.form_at(at).and_then(|form| match form {
            ThinLensForm::Photographic { focal_length_mm, f_number, focus_distance: _, sensor_height_mm } => {
                check::all([
                    check::positive(&at.key("focal_length_mm"), focal_length_mm),
                    check::positive(&at.key("f_number"), f_number),
                    check::positive(&at.key("sensor_height_mm"), sensor_height_mm),
                ])
            }
            ThinLensForm::Angular { fov, focus_distance: _, defocus_angle } => {
                let inside = (0.0..180.0).contains(&defocus_angle);
                let allowed = "a number of at least 0 and below 180";
                check::all([
                    check::between(&at.key("fov"), fov, 0.0, 180.0),
                    check::rule(&at.key("defocus_angle"), defocus_angle, inside, allowed),
                ])
            }
        });
        let focus = check::positive(&at.key("focus_distance"), self.focus_distance);
        check::all([focus, form, validate_blades(at, self.blades)])
    }
}

impl SystemLensFile {
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { prescription, focus_distance, f_number, sensor_height_mm, blades, transmission, coating, .. } = self;
        let ideal = *transmission == Some(LensTransmissionFile::Ideal);
        let lossless = if ideal && (self.ghosts || coating.is_some()) {
            let what = "found \"ideal\" together with `coating` or `ghosts`";
            Err(check::fault(&at.key("transmission"), what, "\"fresnel\", or no `transmission`"))
        } else {
            Ok(())
        };
        check::all([
            lossless,
            coating.as_ref().map_or(Ok(()), |coating| coating.validate(&at.key("coating"))),
            prescription.validate(&at.key("prescription")),
            check::positive(&at.key("focus_distance"), *focus_distance),
            f_number.map_or(Ok(()), |f_number| check::positive(&at.key("f_number"), f_number)),
            check::positive(&at.key("sensor_height_mm"), *sensor_height_mm),
            validate_blades(at, *blades),
        ])
    }
}

impl PrescriptionFile {
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Name(_) => Ok(()),
            Self::Surfaces(surfaces) => validate_surfaces(&at.key("surfaces"), surfaces),
        }
    }
}

fn validate_surfaces(at: &JsonPath, surfaces: &[LensSurfaceFile]) -> Result<()> {
    check::entries(at, surfaces.len(), 1, "at least one surface")?;
    let mut stop = None;
    for (i, surface) in surfaces.iter().enumerate() {
        let at = at.index(i);
        let LensSurfaceFile { radius_mm, conic, aspheric, thickness_mm, ior, semi_aperture_mm, stop: is_stop, coating } =
            surface;
        check::not_negative(&at.key("thickness_mm"), *thickness_mm)?;
        check::positive(&at.key("semi_aperture_mm"), *semi_aperture_mm)?;
        let allowed = format!(
            "0 (a plane) or a magnitude of at least the semi_aperture_mm, {}",
            check::number(*semi_aperture_mm)
        );
        // If `conic` is not 0, `Lens` checks whether the surface reaches the edge of the aperture.
        let wide = *radius_mm == 0.0 || *conic != 0.0 || radius_mm.abs() >= *semi_aperture_mm;
        check::rule(&at.key("radius_mm"), *radius_mm, wide, &allowed)?;
        let orders = aspheric.len();
        if orders > 8 {
            let found = format!("found an array of {orders}");
            return Err(check::fault(&at.key("aspheric"), found, "at most 8 coefficients, of h⁴ to h¹⁸"));
        }
        ior.validate(&at.key("ior"))?;
        coating.as_ref().map_or(Ok(()), |coating| coating.validate(&at.key("coating")))?;
        if *is_stop && let Some(first) = stop.replace(i) {
            let found = format!("found a second stop, after surface {first}");
            return Err(check::fault(&at.key("stop"), found, "at most one"));
        }
    }
    Ok(())
}
