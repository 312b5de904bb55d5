//! `abbe relight`: mixes the light groups of a picture with other gains, without rendering.

use std::path::PathBuf;

use abbe_session::output::exr::{read, write as write_exr};
use abbe_session::output::file;
use abbe_session::output::metadata::{Metadata, names};
use abbe_session::output::png::write as write_png;
use abbe_session::output::relight::{LightGain, light_groups, relight};
use abbe_session::render::on_threads;
use abbe_spectra::error::{Error, Result};
use serde_json::{Map, Value, json};

use super::develop::DisplayArgs;
use super::{Outcome, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct RelightArgs {
    /// The picture: an EXR file with the layers of light groups, which `abbe render --layers
    /// lights` writes
    #[arg(value_name = "PICTURE.exr")]
    picture: PathBuf,
    /// The file of the new picture: a PNG file, or an EXR file with a PNG file beside it
    #[arg(short, long, value_name = "OUT.exr|OUT.png", required_unless_present = "list")]
    output: Option<PathBuf>,
    /// The gain of a light group: a factor such as 2, a colour such as #ff8800, or three factors
    /// for linear red, green and blue such as 1,0.5,0.2. Groups without a gain do not change
    /// (repeatable)
    #[arg(long, value_name = "GROUP=GAIN", value_parser = values::light_gain)]
    set: Vec<LightGain>,
    /// Print the names of the light groups instead of writing a picture
    #[arg(long, conflicts_with_all = ["output", "set"])]
    list: bool,
    #[command(flatten)]
    display: DisplayArgs,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

pub(crate) fn run(arguments: &RelightArgs) -> Result<Outcome> {
    let png = arguments.output.as_ref().map(|output| output.with_extension("png"));
    let outputs = arguments.output.iter().chain(&png).map(PathBuf::as_path);
    file::check_keeps_inputs(outputs, [&arguments.picture])?;
    let file = read(&arguments.picture)?;
    let in_file = |error: Error| error.in_file(&arguments.picture);
    let relit = relight(&file.picture, &arguments.set).map_err(in_file)?;
    let Some(output) = arguments.output.as_ref().filter(|_| !arguments.list) else {
        let names = light_groups(&file.picture).into_iter().map(|name| format!("{name}\n"));
        print::result(&names.collect::<String>())?;
        return Ok(Outcome::Done);
    };
    let has_extension = |known: &str| output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(known));
    if !(has_extension("png") || has_extension("exr")) {
        let what = format!("the output {} is neither a PNG file nor an EXR file", output.display());
        return Err(Error::input(what).expected("a name that ends in .png or .exr"));
    }
    let settings = arguments.display.settings(&file.metadata)?;
    let mut written = Vec::new();
    if has_extension("exr") {
        write_exr(output, &relit, &header(&file.metadata, &arguments.set))?;
        written.push(output.display().to_string());
    }
    let png = output.with_extension("png");
    let exposure = on_threads(None, || {
        let (screen, exposure) = settings.screen_and_factor(&relit);
        write_png(&png, &screen).map(|()| exposure)
    })??;
    written.push(png.display().to_string());
    if !arguments.quiet {
        print::remark(&format!("wrote {}: exposure {}", written.join(" and "), print::exposure(exposure)));
    }
    Ok(Outcome::Done)
}

/// Returns the header of the picture with the gains. Facts about passes and energy stay, because
/// they describe the render, but the record of a saved run does not, because the new picture has no
/// exact sums.
fn header(of_picture: &Metadata, gains: &[LightGain]) -> Metadata {
    let gains: Map<String, Value> = gains.iter().map(|gain| (gain.group.clone(), json!(gain.rgb))).collect();
    let is_kept = |name: &str| name.starts_with("abbe.") && !["abbe.bandUnits", "abbe.run"].contains(&name);
    let own = of_picture.iter().filter(|(name, _)| is_kept(name));
    own.fold(Metadata::new(), |metadata, (name, value)| metadata.with(name, value))
        .with_json(names::RELIGHT, &Value::Object(gains))
}
