//! Executes the directives of a pbrt file.

use super::camera::{ReadCamera, read_camera, read_film};
use super::light::{read_light, read_medium};
use super::state::{GraphicsState, look_at, matrix, transform};
use super::token::{Place, Token, Tokens};
use super::{parameters::Parameters, reader::PbrtReader};
use abbe_format::json::read_text;
use abbe_spectra::colour::RgbSpace;
use abbe_spectra::error::Result;
use abbe_spectra::math::rotation::quaternion;
use glam::{DMat4, DVec3};
use std::path::Path;
use std::rc::Rc;

/// The largest depth of included files, and of nested attributes.
const MAX_DEPTH: usize = 64;

impl PbrtReader<'_> {
    /// Returns a reader of a file, which `main` opens. If the file uses materials before it defines
    /// them, the reader knows all materials of the file.
    pub(super) fn executed(new: impl Fn() -> Self, main: impl Fn() -> Result<Tokens>) -> Result<Self> {
        let mut reader = new();
        let result = reader.execute(main()?);
        let Some(name) = &reader.unknown_material else { return result.map(|()| reader) };
        let mut scan = Self { allows_unknown_materials: true, ..new() };
        if scan.execute(main()?).is_err() || !scan.materials.contains_key(name) {
            return result.map(|()| reader);
        }
        let mut reader = Self { later_materials: scan.materials, ..new() };
        reader.execute(main()?)?;
        Ok(reader)
    }

    fn execute(&mut self, main: Tokens) -> Result<()> {
        // Each file has the state to which its end returns, if it was imported.
        let mut files: Vec<(Tokens, Option<GraphicsState>)> = vec![(main, None)];
        while let Some((tokens, _)) = files.last_mut() {
            let Some(token) = tokens.read()? else {
                if let Some((_, Some(state))) = files.pop() {
                    self.state = state;
                }
                continue;
            };
            let place = tokens.place();
            let Token::Word(directive) = token else {
                return Err(place.error(format!("found {}", describe(&token))).expected("a directive such as Shape"));
            };
            if directive == "Include" || directive == "Import" {
                let name = tokens.string(&directive)?;
                if files.len() >= MAX_DEPTH {
                    return Err(place.error("too many nested files"));
                }
                let path = self.file_access.file(self.base, Path::new(&name))?;
                let text = read_text(&path).map_err(|why| place.error(format!("cannot include \"{name}\": {why}")))?;
                let state = (directive == "Import").then(|| self.state.clone());
                files.push((Tokens::new(text, path.into()), state));
            } else {
                self.directive(&directive, tokens, &place)?;
            }
        }
        Ok(())
    }

    fn directive(&mut self, directive: &str, tokens: &mut Tokens, place: &Place) -> Result<()> {
        match directive {
            "AttributeBegin" | "TransformBegin" => {
                if self.saved.len() >= MAX_DEPTH * MAX_DEPTH {
                    return Err(place.error("too many nested attributes"));
                }
                self.saved.push(self.state.clone());
            }
            "AttributeEnd" => self.state = self.restored(place)?,
            "TransformEnd" => self.state.ctm = self.restored(place)?.ctm,
            "WorldBegin" => {
                self.coordinate_systems.insert("world".into(), DMat4::IDENTITY);
                self.state.ctm = DMat4::IDENTITY;
            }
            "WorldEnd" => {}
            "ReverseOrientation" => self.state.reverse = !self.state.reverse,
            "Identity" => self.set_ctm(DMat4::IDENTITY, place),
            "Translate" | "Scale" | "Rotate" | "LookAt" | "Transform" | "ConcatTransform" => {
                self.transform_directive(directive, tokens, place)?;
            }
            "CoordinateSystem" => {
                let name = tokens.string(directive)?;
                self.coordinate_systems.insert(name, self.state.ctm);
            }
            "CoordSysTransform" => {
                let name = tokens.string(directive)?;
                match self.coordinate_systems.get(&name) {
                    Some(&matrix) => self.set_ctm(matrix, place),
                    None => return Err(place.error(format!("there is no coordinate system \"{name}\""))),
                }
            }
            "ActiveTransform" => match tokens.read()? {
                Some(Token::Word(word)) if ["All", "StartTime", "EndTime"].contains(&word.as_str()) => {
                    self.state.changes_start = word != "EndTime";
                }
                _ => return Err(tokens.place().error("wrong active transform").expected("All, StartTime or EndTime")),
            },
            "TransformTimes" => drop(tokens.numbers::<2>(directive)?),
            "ColorSpace" => {
                let name = tokens.string(directive)?;
                self.state.space = match name.as_str() {
                    "srgb" => RgbSpace::Srgb,
                    "rec2020" => RgbSpace::Rec2020,
                    "dci-p3" => RgbSpace::DisplayP3,
                    _ => {
                        self.scene.leave_out(place.text(), format!("the colour space \"{name}\" is replaced by sRGB"));
                        RgbSpace::Srgb
                    }
                };
            }
            "Option" => {
                // The other options change only how pbrt renders.
                if Parameters::read(tokens)?.flag_or("forcediffuse", false)? {
                    self.scene
                        .leave_out(place.text(), "the option \"forcediffuse\" is left out: materials stay as they are");
                }
            }
            "MediumInterface" => {
                let inside = tokens.string(directive)?;
                let outside = match tokens.peek()? {
                    Some(Token::Quoted(_)) => tokens.string(directive)?,
                    _ => inside.clone(),
                };
                self.state.media = [inside, outside];
            }
            "NamedMaterial" => {
                let name = tokens.string(directive)?;
                if let Some(material) = self.named_material(&name).cloned() {
                    self.state.material = (name, material);
                } else if !self.allows_unknown_materials {
                    let error = place.error(format!("there is no material \"{name}\""));
                    self.unknown_material = Some(name);
                    return Err(error);
                }
            }
            "ObjectBegin" => {
                let name = tokens.string(directive)?;
                self.saved.push(self.state.clone());
                self.objects.insert(name.clone(), Vec::new());
                self.defining = Some(name);
            }
            "ObjectEnd" => {
                self.defining = None;
                self.state = self.restored(place)?;
            }
            "ObjectInstance" => self.instance(tokens, place)?,
            "Attribute" => {
                let target = tokens.string(directive)?;
                if !["shape", "light", "material", "medium", "texture"].contains(&target.as_str()) {
                    let error = place.error(format!("found the attributes of \"{target}\""));
                    return Err(error.expected("shape, light, material, medium or texture"));
                }
                let parameters = self.parameters(tokens, &target)?;
                self.state.defaults.insert(target, parameters);
            }
            "Texture" => self.texture(tokens, place)?,
            "Camera" | "Film" | "Sampler" | "Integrator" | "PixelFilter" | "Accelerator" | "Material"
            | "MakeNamedMaterial" | "MakeNamedMedium" | "LightSource" | "AreaLightSource" | "Shape" => {
                let class = tokens.string(directive)?;
                let target = match directive {
                    "Shape" => "shape",
                    "LightSource" | "AreaLightSource" => "light",
                    "Material" | "MakeNamedMaterial" => "material",
                    "MakeNamedMedium" => "medium",
                    _ => "",
                };
                let parameters = self.parameters(tokens, target)?;
                self.statement(directive, class, parameters, place)?;
            }
            _ => {
                let error = place.error(format!("unknown directive \"{directive}\""));
                return Err(error.expected("a directive of pbrt-v4"));
            }
        }
        Ok(())
    }

    fn statement(&mut self, directive: &str, class: String, parameters: Parameters, place: &Place) -> Result<()> {
        let mut left_out = Vec::new();
        match directive {
            "Camera" => {
                self.coordinate_systems.insert("camera".into(), self.state.ctm.inverse());
                self.camera = read_camera(&class, &parameters, &self.state.ctm, &mut left_out)?;
                if self.camera.as_ref().is_some_and(ReadCamera::needs_mirror) {
                    self.world = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
                }
                self.scene.atmosphere = self.media.get(&self.state.media[1]).cloned();
            }
            "Film" => self.film = read_film(&parameters, &mut left_out)?,
            "Sampler" | "PixelFilter" | "Accelerator" => return Ok(()),
            "Integrator" => {
                if let Some(depth) = parameters.number("maxdepth")? {
                    let what =
                        format!("the limit of {depth} interactions is left out: Abbe follows paths to their end");
                    self.scene.leave_out(place.text(), what);
                }
                return Ok(());
            }
            "Material" => {
                let material = self.material(&class, &parameters, &mut left_out)?;
                let name = if class.is_empty() { "interface".to_string() } else { class.clone() };
                self.state.material = (name, Rc::new(material));
            }
            "MakeNamedMaterial" => {
                let kind = parameters.string("type")?.unwrap_or_default().to_string();
                let material = self.material(&kind, &parameters, &mut left_out)?;
                self.materials.insert(class.clone(), Rc::new(material));
            }
            "MakeNamedMedium" => {
                let to_world = transform(&(self.world * self.state.ctm));
                let spectra = self.spectra();
                if let Some(medium) = read_medium(&parameters, &to_world, &spectra, &mut left_out)? {
                    let name = self.scene.add_medium(&class, medium);
                    self.media.insert(class.clone(), name);
                }
            }
            "LightSource" => {
                let to_world = self.world * self.state.ctm;
                let light = read_light(&class, &parameters, &to_world, self.folder, &self.spectra(), &mut left_out)?;
                self.scene.left_out_lights |= light.is_none();
                light.into_iter().for_each(|light| self.scene.add_light(light));
            }
            "AreaLightSource" => {
                self.state.area_light = (class == "diffuse").then_some(parameters);
                if class != "diffuse" {
                    self.scene.leave_out(place.text(), format!("area light \"{class}\" is left out"));
                }
                return Ok(());
            }
            _ => self.shape(&class, &parameters, place, &mut left_out)?,
        }
        self.note(left_out, &parameters, &format!("{directive} \"{class}\""), place);
        Ok(())
    }

    /// Reads parameters, and adds those that `Attribute` has set for a target.
    fn parameters(&self, tokens: &mut Tokens, target: &str) -> Result<Parameters> {
        let mut parameters = Parameters::read(tokens)?;
        self.state.defaults.get(target).into_iter().for_each(|defaults| parameters.add_defaults(defaults));
        Ok(parameters)
    }

    /// Notes what was left out of a statement, and the parameters that no reader has asked for.
    fn note(&mut self, mut left_out: Vec<String>, parameters: &Parameters, of: &str, place: &Place) {
        let unused = parameters.unused();
        left_out.extend(unused.map(|it| format!("\"{} {}\" of {of} is left out", it.kind, it.name)));
        left_out.into_iter().for_each(|what| self.scene.leave_out(place.text(), what));
    }

    fn texture(&mut self, tokens: &mut Tokens, place: &Place) -> Result<()> {
        let [name, kind, class] = [tokens.string("Texture")?, tokens.string("Texture")?, tokens.string("Texture")?];
        let parameters = self.parameters(tokens, "texture")?;
        let is_scalar = kind == "float";
        let mut left_out = Vec::new();
        let value = self.with_textures(&mut left_out, |textures| textures.read(&class, is_scalar, &parameters))?;
        self.note(left_out, &parameters, &format!("texture \"{class}\""), place);
        self.textures.insert((name, is_scalar), value);
        Ok(())
    }

    fn transform_directive(&mut self, directive: &str, tokens: &mut Tokens, place: &Place) -> Result<()> {
        let step = match directive {
            "Translate" => DMat4::from_translation(tokens.numbers::<3>(directive)?.into()),
            "Scale" => DMat4::from_scale(tokens.numbers::<3>(directive)?.into()),
            "Rotate" => {
                let [degrees, axis @ ..] = tokens.numbers::<4>(directive)?;
                let zero = || place.error("the axis of a rotation is 0");
                let axis = DVec3::from(axis).try_normalize().ok_or_else(zero)?;
                DMat4::from_quat(quaternion(axis, degrees.to_radians()))
            }
            "LookAt" => {
                let numbers = tokens.numbers::<9>(directive)?;
                let [eye, at, up] = [0, 3, 6].map(|i| DVec3::new(numbers[i], numbers[i + 1], numbers[i + 2]));
                look_at(eye, at, up).ok_or_else(|| place.error("the directions of LookAt are parallel or 0"))?
            }
            _ => matrix(&tokens.numbers::<16>(directive)?),
        };
        let ctm = if directive == "Transform" { step } else { self.state.ctm * step };
        self.set_ctm(ctm, place);
        Ok(())
    }
}

fn describe(token: &Token) -> String {
    match token {
        Token::Quoted(text) => format!("the string \"{text}\""),
        Token::Number(number) => format!("the number {number}"),
        Token::Open => "\"[\"".into(),
        Token::Close => "\"]\"".into(),
        Token::Word(word) => format!("\"{word}\""),
    }
}
