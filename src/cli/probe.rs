//! `abbe probe`: prints one pixel of a picture.

use std::path::PathBuf;

use abbe_session::output::exr::read;
use abbe_session::output::file;
use abbe_session::output::heat::error_map;
use abbe_session::output::plot::{SpectralCurve, SpectralPlot};
use abbe_session::output::png::write as write_png;
use abbe_session::output::stokes::{PixelStokes, pixel_stokes};
use abbe_spectra::colour::gamut::desaturate;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::colour::{RgbSpace, srgb_hex, xy, xyz_to_linear_srgb};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::BAND_NM;
use abbe_transport::sensor::{Picture, exposure};
use serde::Serialize;

use super::print::percent;
use super::{Outcome, print};

#[derive(Debug, clap::Args)]
pub(crate) struct ProbeArgs {
    /// The picture
    #[arg(value_name = "FILE.exr")]
    picture: PathBuf,
    /// The column, counted from 0 at the left
    #[arg(value_name = "X")]
    x: usize,
    /// The row, counted from 0 at the top
    #[arg(value_name = "Y")]
    y: usize,
    /// Plot the spectrum of the pixel
    #[arg(long, value_name = "FILE.svg")]
    svg: Option<PathBuf>,
    /// Write a heat map of the relative error of the whole picture
    #[arg(long, value_name = "FILE.png")]
    heat: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// The values of a pixel.
#[derive(Debug, Serialize)]
struct PixelReport {
    pixel: [usize; 2],
    /// Y in cd/m².
    xyz: [f64; 3],
    /// Null for a black pixel.
    xy: Option<[f64; 2]>,
    /// White of 1 cd/m² has the components 1, 1, 1.
    linear_srgb: [f64; 3],
    /// The sRGB colour at automatic exposure.
    srgb_hex: String,
    /// Standard error of Y in cd/m², or null if unknown.
    noise: Option<f64>,
    /// Estimated bias of Y in cd/m², or null if unknown.
    bias: Option<f64>,
    /// Whether the pixel is near an edge of the illumination, where the bias may be larger than the
    /// estimate; null if this is unknown.
    edge: Option<bool>,
    /// The ratio √(noise² + bias²) / Y.
    relative_error: Option<f64>,
    /// The 95 % confidence interval of Y in cd/m².
    interval_95: Option<[f64; 2]>,
    /// The polarisation, or null if the picture has no layer `stokes`.
    polarisation: Option<PixelStokes>,
    spectrum: Option<PixelBands>,
}

#[derive(Debug, Serialize)]
struct PixelBands {
    nm: Vec<f64>,
    /// The spectral radiance in each band, in W/m²/sr/nm.
    values: Vec<f64>,
}

pub(crate) fn run(arguments: &ProbeArgs) -> Result<Outcome> {
    let outputs = [&arguments.svg, &arguments.heat].into_iter().flatten().map(PathBuf::as_path);
    file::check_keeps_inputs(outputs, [&arguments.picture])?;
    let picture = read(&arguments.picture)?.picture;
    let pixel = pixel(&picture, arguments.x, arguments.y).map_err(|error| error.in_file(&arguments.picture))?;
    if let Some(path) = &arguments.svg {
        let Some(PixelBands { nm, values }) = &pixel.spectrum else {
            let error =
                Error::input("the picture holds no spectra").expected("a picture rendered with --spectral-bands");
            return Err(error.in_file(&arguments.picture));
        };
        let plot = SpectralPlot {
            title: format!("{}, pixel {}, {}", arguments.picture.display(), arguments.x, arguments.y),
            values: "radiance in W/m²/sr/nm".to_string(),
            curves: vec![SpectralCurve { name: "radiance".to_string(), points: steps(nm, values) }],
            lines: Vec::new(),
            from_zero: true,
        };
        file::write_whole(path, plot.svg().as_bytes())?;
    }
    if let Some(path) = &arguments.heat {
        write_png(path, &error_map(&picture))?;
    }
    if arguments.json {
        print::json(&pixel)?
    } else {
        print::result(&text(&pixel))?
    }
    Ok(Outcome::Done)
}

/// Returns a step curve through the mean value of each band. The steps meet at the midpoints
/// between the centres of neighbouring bands.
fn steps(nm: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let last = nm.len() - 1;
    let middle = |i: usize| 0.5 * (nm[i] + nm[i + 1]);
    let edges = |i: usize| match (i > 0, i < last) {
        (true, true) => (middle(i - 1), middle(i)),
        (true, false) => (middle(i - 1), 2.0 * nm[i] - middle(i - 1)),
        (false, true) => (2.0 * nm[i] - middle(i), middle(i)),
        // A single band covers the whole range of wavelengths.
        (false, false) => BAND_NM,
    };
    let step = |(i, &value): (usize, &f64)| [(edges(i).0, value), (edges(i).1, value)];
    values.iter().enumerate().flat_map(step).collect()
}

fn pixel(picture: &Picture, x: usize, y: usize) -> Result<PixelReport> {
    let (width, height) = (picture.width, picture.height);
    if x >= width || y >= height {
        let what = format!("the pixel {x}, {y} in a picture of {width} × {height} pixels");
        return Err(Error::input(what).expected(format!("0 ≤ X < {width} and 0 ≤ Y < {height}")));
    }
    let i = y * width + x;
    let xyz = picture.xyz[i];
    let exposure = exposure::automatic(picture);
    let exposed = xyz_to_linear_srgb(xyz.map(|value| value * exposure));
    let spectrum = picture.bands.as_ref().map(|bands| {
        let count = bands.centres_nm.len();
        let values = bands.values[i * count..(i + 1) * count].iter().map(|&value| f64::from(value)).collect();
        PixelBands { nm: bands.centres_nm.clone(), values }
    });
    let error = picture.error(i);
    let half_interval = picture.half_interval_95(i, 0.0);
    Ok(PixelReport {
        pixel: [x, y],
        xyz,
        xy: (xyz.iter().sum::<f64>() > 0.0).then(|| xy(xyz)),
        linear_srgb: xyz_to_linear_srgb(xyz),
        srgb_hex: srgb_hex(desaturate(ToneCurve::default().apply(exposed, RgbSpace::Srgb), RgbSpace::Srgb)),
        noise: picture.noise[i].map(f64::from),
        bias: picture.bias[i].map(f64::from),
        edge: picture.edge[i],
        relative_error: error.filter(|_| xyz[1] > 0.0).map(|error| error / xyz[1]),
        // Luminance is not negative.
        interval_95: half_interval.map(|half_interval| [(xyz[1] - half_interval).max(0.0), xyz[1] + half_interval]),
        polarisation: pixel_stokes(picture, i),
        spectrum,
    })
}

fn text(pixel: &PixelReport) -> String {
    let PixelReport { pixel: [x, y], xyz, xy, linear_srgb: [r, g, b], srgb_hex, noise, bias, .. } = pixel;
    let PixelReport { edge, relative_error, interval_95, polarisation, spectrum, .. } = pixel;
    let bar = |value: &Option<f64>| value.map_or("unknown".to_string(), |value| format!("{value:.6} cd/m²"));
    let mut text =
        format!("pixel        {x}, {y}\nXYZ          {:.6}  {:.6}  {:.6}   (Y in cd/m²)\n", xyz[0], xyz[1], xyz[2]);
    if let Some([x, y]) = xy {
        text += &format!("xy           {x:.5}  {y:.5}\n");
    }
    text += &format!("linear sRGB  {r:.6}  {g:.6}  {b:.6}\nsRGB         {srgb_hex} at automatic exposure\n");
    let beside = if *edge == Some(true) { ", or larger: the pixel is near an edge of light" } else { "" };
    text += &format!("noise of Y   {}\nbias of Y    {}{beside}\n", bar(noise), bar(bias));
    text += &match (relative_error, interval_95) {
        (Some(error), Some([low, high])) => {
            format!("error of Y   {} (noise and bias): 95 % within {low:.6} … {high:.6} cd/m²\n", percent(*error))
        }
        (_, _) => "error of Y   unknown\n".to_string(),
    };
    if let Some(PixelStokes { stokes: [s0, parts @ ..], noise, degree, angle_deg }) = polarisation {
        let each = parts.iter().zip(noise).map(|(part, noise)| format!("{part:.6} ± {noise:.6}"));
        let each = each.collect::<Vec<_>>().join("  ");
        text += &format!("Stokes       {s0:.6}  {each}   (cd/m², standard errors)\n");
        text += &format!("polarised    {}, at {angle_deg:.2}° from the horizontal\n", percent(*degree));
    }
    match spectrum {
        Some(PixelBands { nm, values }) => {
            text += "spectrum     nm, W/m²/sr/nm\n";
            nm.iter().zip(values).for_each(|(nm, value)| text += &format!("  {nm:8.3}  {value:.6e}\n"));
        }
        None => text += "spectrum     none (render with --spectral-bands)\n",
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_are_drawn_over_their_whole_width() {
        let drawn = steps(&[400.0, 500.0, 600.0], &[1.0, 2.0, 3.0]);
        assert_eq!(drawn, [(350.0, 1.0), (450.0, 1.0), (450.0, 2.0), (550.0, 2.0), (550.0, 3.0), (650.0, 3.0)]);
        assert_eq!(steps(&[595.0], &[4.0]), [(360.0, 4.0), (830.0, 4.0)]);
    }
}
