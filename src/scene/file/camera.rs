//! The camera, its lens and its shutter as written.

use glam::DVec3;
use schemars::JsonSchema;
use serde::de::MapAccess;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::check;
use super::forms::{self, Form, Forms};
use super::index::IndexFile;
use super::path::JsonPath;
use crate::error::{Error, Result};
use crate::scene::motion::CameraMotion;

/// The camera.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraFile {
    /// Where it stands.
    pub from: [f64; 3],
    /// A point that is seen in the picture's middle.
    pub at: [f64; 3],
    /// A direction that is up in the picture (default: +y).
    #[serde(default = "default_up")]
    pub up: [f64; 3],
    /// Its lens.
    pub lens: LensFile,
    /// When it is open (default: all motion stands still at time 0).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shutter: Option<ShutterFile>,
    /// How it moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub motion: Vec<CameraKeyframeFile>,
}

/// +y.
fn default_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// One key of the camera's motion; what it leaves out is as in the camera.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CameraKeyframeFile {
    /// The moment in s.
    pub time: f64,
    /// Where the camera stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<[f64; 3]>,
    /// A point that is seen in the picture's middle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 3]>,
    /// A direction that is up in the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<[f64; 3]>,
}

/// When the camera is open.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShutterFile {
    /// It opens, in s.
    pub open: f64,
    /// It closes, in s.
    pub close: f64,
    /// Transmission over the time it is open: pairs of a time from 0 to 1 and a transmission from 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve: Option<Vec<[f64; 2]>>,
}

/// What projects the scene onto the film.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum LensFile {
    /// Everything is sharp.
    Pinhole {
        /// Vertical field of view in degrees.
        #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
        fov: f64,
    },
    /// An ideal lens with depth of field.
    Thin(ThinLensFile),
    /// Real glass, traced for each wavelength.
    System(SystemLensFile),
}

/// A thin lens, in one of two forms: `focal_length_mm`, `f_number`, `focus_distance`, `sensor_height_mm`; or `fov`,
/// `focus_distance`, `defocus_angle`.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThinLensFile {
    /// Focal length in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub focal_length_mm: Option<f64>,
    /// Focal length over the diameter of the pupil.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub f_number: Option<f64>,
    /// Distance from the lens of the plane that is sharp, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub focus_distance: f64,
    /// Height of the sensor in mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sensor_height_mm: Option<f64>,
    /// Vertical field of view in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 180))]
    pub fov: Option<f64>,
    /// Apex angle in degrees of the cone from a point in focus to the pupil.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0), extend("exclusiveMaximum" = 180))]
    pub defocus_angle: Option<f64>,
    /// Blades of a polygonal stop (default: round).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 3, max = 64))]
    pub blades: Option<u32>,
    /// Rotation of the stop in degrees.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub rotation: f64,
    /// Whether light is diffracted at the stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub diffraction: bool,
}

/// The two forms of a thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ThinLensForm {
    /// As a photographer states it.
    Photographic {
        /// Focal length in mm.
        focal_length_mm: f64,
        /// Focal length over the diameter of the pupil.
        f_number: f64,
        /// Distance of the plane that is sharp, in the scene's unit.
        focus_distance: f64,
        /// Height of the sensor in mm.
        sensor_height_mm: f64,
    },
    /// By angles.
    Angular {
        /// Vertical field of view in degrees.
        fov: f64,
        /// Distance of the plane that is sharp, in the scene's unit.
        focus_distance: f64,
        /// Apex angle in degrees of the cone from a point in focus to the pupil.
        defocus_angle: f64,
    },
}

/// A lens system.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SystemLensFile {
    /// Its surfaces.
    pub prescription: PrescriptionFile,
    /// Distance of the plane that is sharp, in the scene's unit.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub focus_distance: f64,
    /// f-number that it is stopped down to (default: fully open).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub f_number: Option<f64>,
    /// Height of the sensor in mm.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub sensor_height_mm: f64,
    /// Blades of a polygonal stop (default: round).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 3, max = 64))]
    pub blades: Option<u32>,
    /// Rotation of the stop in degrees.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub rotation: f64,
    /// Whether light is diffracted at the stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub diffraction: bool,
}

/// A lens prescription: the name of a built-in one, the path of a file, or its surfaces.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(remote = "Self", rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "PrescriptionFile", transform = forms::or_name)]
pub enum PrescriptionFile {
    /// A built-in prescription's name, or a path relative to the scene's folder.
    #[serde(skip)]
    Name(String),
    /// The surfaces, from the scene to the sensor.
    Surfaces(Vec<LensSurfaceFile>),
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

/// One surface of a lens system.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LensSurfaceFile {
    /// Radius in mm: above 0 where its centre lies towards the sensor; 0 or null is a plane.
    #[serde(deserialize_with = "forms::deserialize_radius")]
    #[schemars(schema_with = "forms::radius_or_plane")]
    pub radius_mm: f64,
    /// Conic constant: 0 (the default) is a sphere, −1 a paraboloid.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub conic: f64,
    /// What an even asphere adds to the conic: coefficients of h⁴, h⁶, … in mm⁻³, mm⁻⁵, …, h being the distance from the axis in mm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 8))]
    pub aspheric: Vec<f64>,
    /// Distance to the next surface in mm.
    #[schemars(range(min = 0))]
    pub thickness_mm: f64,
    /// Index of refraction behind the surface; 1 is air.
    pub ior: IndexFile,
    /// Half the clear diameter in mm.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub semi_aperture_mm: f64,
    /// Whether this is the aperture stop.
    #[serde(default, skip_serializing_if = "forms::is_default")]
    pub stop: bool,
}

impl CameraFile {
    /// Its way through all keyframes, in the scene's unit; `None` if it has none.
    pub fn way(&self) -> Option<CameraMotion> {
        CameraMotion::new(self.motion.iter().map(|key| {
            let [from, at, up] = [(key.from, self.from), (key.at, self.at), (key.up, self.up)];
            (key.time, [from, at, up].map(|(own, cameras)| DVec3::from(own.unwrap_or(cameras))))
        }))
    }

    /// Checks ranges and directions.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { from, at: target, up, lens, shutter, motion } = self;
        validate_pose(at, "at", [*from, *target, *up])?;
        lens.validate(&at.key("lens"))?;
        if let Some(shutter) = shutter {
            shutter.validate(&at.key("shutter"))?;
        }
        let at = at.key("motion");
        check::rising(&at, motion.iter().map(|key| key.time), Some("time"))?;
        for (i, key) in motion.iter().enumerate() {
            let last_written = if key.at.is_some() { "at" } else { "from" };
            let pose = [key.from.unwrap_or(*from), key.at.unwrap_or(*target), key.up.unwrap_or(*up)];
            validate_pose(&at.index(i), last_written, pose)?;
        }
        if let Some(time_s) = self.way().and_then(|way| way.lost_s()) {
            let what =
                format!("found a way on which the camera, at {time_s:.3} s, looks along its `up` or at its own place");
            return Err(check::fault(&at, what, "a view that stays clear of both; put keys in between"));
        }
        Ok(())
    }
}

/// Checks that the camera looks somewhere, and that up is not along its view. `key` is the key to blame where it looks
/// at itself.
fn validate_pose(camera: &JsonPath, key: &str, [from, at, up]: [[f64; 3]; 3]) -> Result<()> {
    check::direction(&camera.key("up"), up)?;
    let (key, value, other_key, other) = if key == "at" { ("at", at, "from", from) } else { ("from", from, "at", at) };
    check::apart(&camera.key(key), value, other_key, other)?;
    let view = (DVec3::from_array(at) - DVec3::from_array(from)).normalize_or_zero();
    let sine = view.cross(DVec3::from_array(up).normalize_or_zero()).length();
    if sine > 1e-9 {
        return Ok(());
    }
    let found = format!("found {}, which lies along the view", check::triple(up));
    Err(check::fault(&camera.key("up"), found, "a direction across the view"))
}

impl ShutterFile {
    /// Checks that it closes after it opens, and its curve.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { open, close, curve } = self;
        let allowed = format!("a time of at least {}, when it opens", check::number(*open));
        check::rule(&at.key("close"), *close, close >= open, &allowed)?;
        let Some(curve) = curve else { return Ok(()) };
        let at = at.key("curve");
        check::entries(&at, curve.len(), 2, "at least 2 pairs of time and transmission")?;
        for (i, &[time, transmission]) in curve.iter().enumerate() {
            check::share(&at.index(i).index(0), time)?;
            check::share(&at.index(i).index(1), transmission)?;
        }
        let rising = curve.windows(2).position(|pair| pair[1][0] <= pair[0][0]);
        if let Some(i) = rising {
            let allowed = format!("a number above {}", check::number(curve[i][0]));
            return check::rule(&at.index(i + 1).index(0), curve[i + 1][0], false, &allowed);
        }
        if curve.iter().all(|point| point[1] == 0.0) {
            return Err(check::fault(&at, "found a shutter that never lets light through", "a transmission above 0"));
        }
        Ok(())
    }
}

impl LensFile {
    /// Checks ranges and forms.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Pinhole { fov } => check::between(&at.key("pinhole").key("fov"), *fov, 0.0, 180.0),
            Self::Thin(lens) => lens.validate(&at.key("thin")),
            Self::System(lens) => lens.validate(&at.key("system")),
        }
    }
}

/// Checks a polygonal stop.
fn validate_blades(at: &JsonPath, blades: Option<u32>) -> Result<()> {
    blades.map_or(Ok(()), |blades| check::count(&at.key("blades"), u64::from(blades), 3, 64))
}

impl ThinLensFile {
    /// The form it is stated in; an error where keys are missing or both forms are mixed.
    pub fn form(&self) -> Result<ThinLensForm> {
        self.form_at(&JsonPath::Root)
    }

    /// The form, with errors at the lens's place.
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
        let first =
            |keys: &[(&'static str, Option<f64>)]| keys.iter().find(|(_, it)| it.is_some()).map(|(key, _)| *key);
        let missing = |keys: &[(&'static str, Option<f64>)]| -> Error {
            let key = keys.iter().find(|(_, it)| it.is_none()).map_or("", |(key, _)| *key);
            check::fault(at, format!("missing key \"{key}\""), EXPECTED)
        };
        match (first(&photographic), first(&angular)) {
            (Some(one), Some(other)) => Err(check::fault(&at.key(other), format!("found beside `{one}`"), EXPECTED)),
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

    /// Checks ranges and the form.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        check::positive(&at.key("focus_distance"), self.focus_distance)?;
        match self.form_at(at)? {
            ThinLensForm::Photographic { focal_length_mm, f_number, focus_distance: _, sensor_height_mm } => {
                check::positive(&at.key("focal_length_mm"), focal_length_mm)?;
                check::positive(&at.key("f_number"), f_number)?;
                check::positive(&at.key("sensor_height_mm"), sensor_height_mm)?;
            }
            ThinLensForm::Angular { fov, focus_distance: _, defocus_angle } => {
                check::between(&at.key("fov"), fov, 0.0, 180.0)?;
                let inside = (0.0..180.0).contains(&defocus_angle);
                let allowed = "a number of at least 0 and below 180";
                check::rule(&at.key("defocus_angle"), defocus_angle, inside, allowed)?;
            }
        }
        validate_blades(at, self.blades)
    }
}

impl SystemLensFile {
    /// Checks ranges and surfaces.
    fn validate(&self, at: &JsonPath) -> Result<()> {
        let Self { prescription, focus_distance, f_number, sensor_height_mm, blades, rotation: _, diffraction: _ } =
            self;
        prescription.validate(&at.key("prescription"))?;
        check::positive(&at.key("focus_distance"), *focus_distance)?;
        f_number.map_or(Ok(()), |f_number| check::positive(&at.key("f_number"), f_number))?;
        check::positive(&at.key("sensor_height_mm"), *sensor_height_mm)?;
        validate_blades(at, *blades)
    }
}

impl PrescriptionFile {
    /// Checks the surfaces, if they stand here.
    pub(super) fn validate(&self, at: &JsonPath) -> Result<()> {
        match self {
            Self::Name(_) => Ok(()),
            Self::Surfaces(surfaces) => validate_surfaces(&at.key("surfaces"), surfaces),
        }
    }
}

/// Checks the surfaces of a prescription: at least one, at most one stop, each wide enough for its radius.
fn validate_surfaces(at: &JsonPath, surfaces: &[LensSurfaceFile]) -> Result<()> {
    check::entries(at, surfaces.len(), 1, "at least one surface")?;
    let mut stop = None;
    for (i, surface) in surfaces.iter().enumerate() {
        let at = at.index(i);
        let LensSurfaceFile { radius_mm, conic, aspheric, thickness_mm, ior, semi_aperture_mm, stop: is_stop } =
            surface;
        check::not_negative(&at.key("thickness_mm"), *thickness_mm)?;
        check::positive(&at.key("semi_aperture_mm"), *semi_aperture_mm)?;
        let allowed =
            format!("0 (a plane) or a size of at least the semi_aperture_mm, {}", check::number(*semi_aperture_mm));
        // How far another conic reaches is seen when the lens is built.
        let wide = *radius_mm == 0.0 || *conic != 0.0 || radius_mm.abs() >= *semi_aperture_mm;
        check::rule(&at.key("radius_mm"), *radius_mm, wide, &allowed)?;
        let orders = aspheric.len();
        if orders > 8 {
            let found = format!("found an array of {orders}");
            return Err(check::fault(&at.key("aspheric"), found, "at most 8 coefficients, of h⁴ to h¹⁸"));
        }
        ior.validate(&at.key("ior"))?;
        if *is_stop && let Some(first) = stop.replace(i) {
            let found = format!("found a second stop, after surface {first}");
            return Err(check::fault(&at.key("stop"), found, "at most one"));
        }
    }
    Ok(())
}
