//! What a study found, as one page that needs no other file.

use maud::{Markup, PreEscaped, html};

use super::curves::Curve;
use super::effects::{Cost, Effects, LeftOut, Without};
use super::reference::Estimate;
use super::report::{Report, signed, theory, title_of};
use super::subject::Recipe;
use super::truth::Truth;
use super::{Point, SHARES};
use crate::error::Result;
use crate::output::compare::{DeltaE, Selection};
use crate::output::comparison_page::colour_differences;
use crate::output::data_uri::data_uri;
use crate::output::graph::power_of_ten;
use crate::output::page::document;
use crate::output::png::encode;
use crate::render::{Integrator, Job};
use crate::sensor::{Development, Picture, Screen, develop, exposure};

/// The pictures that the page shows, all at the reference's exposure.
#[derive(Debug)]
pub(super) struct Pictures<'a> {
    development: Development,
    exposure: f64,
    /// Those that can be compared, with their names: reference, photons, path tracer, then without each effect.
    full: Vec<(String, &'a Picture)>,
    /// The picture with all effects.
    whole: &'a Picture,
}

/// The places of the first pictures.
const REFERENCE: usize = 0;
const PHOTONS: usize = 1;
const FIRST_EFFECT: usize = 3;

/// Thumbnails are at most this wide, in pixels.
const THUMBNAIL: usize = 160;

impl<'a> Pictures<'a> {
    pub(super) fn of(job: &Job, truth: &'a Truth, curves: &'a [Curve; 2], effects: &'a Effects) -> Self {
        let film = &job.scene.film;
        let development = Development { white: film.white, gamut: film.gamut, ..Development::default() };
        let reference = &truth.reference.picture;
        let exposure = exposure::automatic(reference, &development);
        let of_curve = |curve: &'a Curve| {
            let name = format!("{}, {}", title_of(curve.integrator), passes(curve.stats.passes));
            (name, &curve.picture)
        };
        let without = effects.on.iter().filter_map(|effect| {
            Some((format!("without {}, {}", effect.name, passes(effects.passes)), effect.picture.as_ref()?))
        });
        let first = [("reference".to_string(), reference), of_curve(&curves[0]), of_curve(&curves[1])];
        Self { development, exposure, full: first.into_iter().chain(without).collect(), whole: &effects.picture }
    }

    fn shown(&self, picture: &Picture) -> Screen {
        develop(picture, self.exposure, &self.development)
    }
}

fn image(screen: &Screen, words: &str) -> Result<Markup> {
    let source = data_uri("image/png", &encode(screen)?);
    Ok(html! { img src=(source) alt=(words) width=(screen.width) height=(screen.height); })
}

/// The page.
///
/// # Errors
/// The machine's: pictures too large for PNG.
pub(super) fn page(report: &Report, pictures: &Pictures<'_>) -> Result<String> {
    let title = format!("What accuracy costs: {}", report.title);
    let body = html! {
        header {
            h1 { "What accuracy costs" }
            p.lead { (report.title) }
            (summary(report))
        }
        (compared(pictures)?)
        (wanted(report))
        (curves(report))
        (sweep(report))
        (effects(report, pictures)?)
        (method(report))
        script { (PreEscaped(include_str!("page.js"))) }
    };
    Ok(document(&title, include_str!("page.css"), &body))
}

fn summary(report: &Report) -> Markup {
    let film = &report.film;
    let (error, passes) = report
        .sweep
        .default
        .map_or_else(|| (None, report.curves[0].passes_wanted), |point| (Some(point.wrong.whole), point.passes));
    html! {
        p {
            @if let Some((point, error)) = report.sweep.default.zip(error) {
                "As the scene is set (" (passes) " passes), its picture is good to " strong { (typical(error.value)) }
                " (relMSE " (short(error.value)) ") after " strong { (time(point.seconds)) } ". "
            } @else {
                "The study ended before the " (passes) " passes that the scene asks for. "
            }
            "All times are those of " (report.machine.words()) ", all errors those of pictures of "
            (film.width) " × " (film.height) " pixels"
            @if film.pixel_ratio() > 1.0 { " (the scene's film has " (film.own_width) " × " (film.own_height) ")" }
            "."
        }
    }
}

fn compared(pictures: &Pictures<'_>) -> Result<Markup> {
    let (width, height) = pictures.full.first().map_or((1, 1), |(_, picture)| (picture.width, picture.height));
    let choice = |id: &str, words: &str, chosen: usize| {
        html! {
            label { (words) " "
                select id=(id) {
                    @for (i, (name, _)) in pictures.full.iter().enumerate() {
                        option value=(i) selected[i == chosen] { (name) }
                    }
                }
            }
        }
    };
    let images = pictures.full.iter().map(|(name, picture)| image(&pictures.shown(picture), name));
    let images: Vec<Markup> = images.collect::<Result<_>>()?;
    Ok(html! {
        section id="compare" {
            h2 { "Two pictures" }
            div.choices { (choice("left", "Left", PHOTONS)) (choice("right", "Right", REFERENCE)) }
            div.stage id="stage" style={ "aspect-ratio:" (width) "/" (height) } {
                img id="under" alt="the left picture";
                img id="over" alt="the right picture";
                div.handle {}
                input id="split" type="range" min="0" max="100" step="0.1" value="50" aria-label="where the left picture ends";
            }
            p.soft { "Drag across the picture. All are shown at the reference's exposure." }
            div.pictures hidden { @for image in &images { (image) } }
        }
    })
}

fn wanted(report: &Report) -> Markup {
    html! {
        section {
            h2 { "The error you want, and what it takes" }
            @if report.wanted.is_empty() {
                p { "No error could be told from the reference's own noise in this time: give the study a larger budget." }
            } @else {
                div.table { table.grid {
                    thead { tr {
                        th.number { "error" } th.number { "relMSE" } th.number { "time" } th { "settings" } th.number { "passes" } th { "command" }
                    } }
                    tbody { @for row in &report.wanted { tr {
                        td.number { strong { (typical(row.relative_mse)) } }
                        td.number { (short(row.relative_mse)) }
                        td.number { strong { (time(row.seconds_own_film)) } @if row.extrapolated { " *" } }
                        td { (row.settings) }
                        td.number { (row.passes) }
                        td { code { (row.command) } }
                    } } }
                } }
                p.soft {
                    "Error is the square root of relMSE, which " code { "abbe compare" } " defines. Times are for the scene's own film, from the "
                    "study's by the number of pixels; passes are those of the study's film."
                    @if report.wanted.iter().any(|row| row.extrapolated) {
                        " * The study did not get so far: from its last picture on, the error is taken to fall as theory says."
                    }
                }
            }
        }
    }
}

fn curves(report: &Report) -> Markup {
    let in_smooth = report.reference.smooth_share.is_some();
    html! {
        section {
            h2 { "Error against time" }
            div.with-plot {
                figure { (PreEscaped(report.curves_graph().svg())) }
                div {
                    div.table { table.grid {
                        thead { tr { th {} th.number { "fitted slope" } th.number { "theory" } } }
                        tbody { @for curve in &report.curves {
                            tr {
                                th scope="row" { (title_of(curve.integrator)) ", over passes" }
                                td.number { strong { (slope(curve.fit)) } }
                                td.number { (theory(curve)) }
                            }
                            tr { th.soft scope="row" { "over seconds" } td.number { (slope(curve.fit_seconds)) } td {} }
                            @for theory in &curve.theory {
                                tr { th.soft scope="row" { (theory.estimator) } td {} td.number.soft { (signed(theory.slope)) } }
                            }
                        } }
                    } }
                    p.soft {
                        @if let Some(share) = report.reference.smooth_share {
                            "Lines and slopes: smooth regions (" (percent(share)) " of the pixels); dots: the whole picture. "
                        } @else {
                            "The picture has too few smooth regions: lines and slopes are those of the whole picture, where edges make kernels slower than theory says. "
                        }
                        "Dashed: the slopes of theory, from the first point of the fit. Slopes are fitted by least squares to the logarithms, from 4 passes on, to "
                        "errors that stand three standard errors clear of the reference's noise; ± is the fit's standard error. "
                        @if in_smooth { "Where several estimators add up, the least steep of them decides in the end; before, the noise of the others does, and even spreading of "
                        "wavelengths and places makes that fall faster than 1/N. " }
                        "Against seconds the pilot counts too."
                    }
                }
            }
            (lost_light(report))
        }
    }
}

/// Says so where the path tracer's error has a floor.
fn lost_light(report: &Report) -> Markup {
    html! { @if let Some(reason) = &report.reference.out_of_reach {
        p.warning { "The path tracer's error cannot fall to zero here: " (reason) "." }
    } }
}

fn sweep(report: &Report) -> Markup {
    let sweep = &report.sweep;
    html! {
        section {
            h2 { "Settings" }
            div.with-plot {
                figure { (PreEscaped(report.sweep_graph().svg())) }
                div {
                    p { "The Pareto front: nothing that was tried has a smaller error in less time." }
                    div.table { table.grid {
                        thead { tr { th.number { "time" } th.number { "error" } th.number { "passes" } th { "settings" } } }
                        tbody {
                            @for place in &sweep.front { (place_row(&place.point, &sweep.runs[place.run].recipe(), "")) }
                            @if let Some(default) = &sweep.default { (place_row(default, &Recipe::DEFAULT, "default")) }
                        }
                    } }
                }
            }
            p.soft {
                "One setting is changed at a time; each line is one render as its passes add up. "
                @if sweep.default.is_some() { "The ring is the scene as it is set. " }
                @if !sweep.left_out.is_empty() {
                    "Left out for want of time: "
                    (sweep.left_out.iter().map(|change| change.words()).collect::<Vec<_>>().join("; ")) ". "
                }
                "Fixed by design, and so not swept: " (report.fixed_by_design.join("; ")) "."
            }
        }
    }
}

fn place_row(point: &Point, recipe: &Recipe, class: &str) -> Markup {
    html! { tr class=(class) {
        td.number { (time(point.seconds)) }
        td.number { (typical(point.wrong.whole.value)) }
        td.number { (point.passes) }
        td { (if recipe.integrator == Integrator::Path { "path tracer".to_string() } else { recipe.words() }) @if class == "default" { " (default)" } }
    } }
}

fn effects(report: &Report, pictures: &Pictures<'_>) -> Result<Markup> {
    let effects = &report.effects;
    let mut place = FIRST_EFFECT;
    let whole = shrunk(pictures.whole);
    let mut cards = Vec::new();
    for effect in &effects.on {
        let at = effect.picture.is_some().then_some(place);
        place += usize::from(effect.picture.is_some());
        cards.push(card(effect, effects, (pictures, &whole), at)?);
    }
    Ok(html! {
        section {
            h2 { "Effect by effect" }
            p {
                "Each effect that the scene calls for is left out in turn, for " (passes(effects.passes)) " of the same seed. With all of them these take "
                (time(effects.with.seconds)) " and " (bytes(effects.with.memory_bytes)) ". Noise alone makes ΔE "
                (format!("{:.2}", effects.noise_delta_e_2000.mean)) " and relMSE " (short(effects.noise_relative_mse)) " between two seeds; pictures of the same seed share most of it, but where an effect gives random numbers another meaning (aim, dispersion) it "
                "stays in the difference."
            }
            div.cards { @for card in &cards { (card) } }
            h3 { "Off in this scene" }
            div.table { table.grid {
                thead { tr { th { "effect" } th.number { "events" } th { "because" } } }
                tbody { @for off in &effects.off {
                    tr { th scope="row" { (off.name) } td.number { (off.events) } td { @if off.state != "off" { (off.state) "; " } (off.because) } }
                } }
            } }
        }
    })
}

fn card(
    effect: &Without,
    effects: &Effects,
    (pictures, whole): (&Pictures<'_>, &Picture),
    at: Option<usize>,
) -> Result<Markup> {
    let figures = match &effect.left_out {
        LeftOut::Measured { cost, relative_mse, delta_e_2000, wrong } => {
            measured(effects, cost, (*relative_mse, delta_e_2000), *wrong)
        }
        LeftOut::Refused(reason) => html! { p.soft { "Cannot be left out: " (reason) "." } },
        LeftOut::NoTime => html! { p.soft { "No time was left for it." } },
    };
    let thumbnails = match &effect.picture {
        Some(picture) => {
            let without = shrunk(picture);
            let difference = colour_differences(&without, whole, &Selection::default());
            let three = [
                (pictures.shown(whole), "with"),
                (pictures.shown(&without), "without"),
                (difference, "ΔE, white at 10"),
            ];
            three.into_iter().map(|(screen, words)| Ok((image(&screen, words)?, words))).collect::<Result<Vec<_>>>()?
        }
        None => Vec::new(),
    };
    Ok(html! {
        article.card {
            h3 { (effect.name) @if effect.state == "forced" { " (forced)" } }
            p.soft { (effect.because) "; " (effect.events) " events" }
            @if !thumbnails.is_empty() {
                div.three { @for (image, words) in &thumbnails { figure { (image) figcaption { (words) } } } }
            }
            (figures)
            @if let Some(at) = at { button type="button" data-left=(PHOTONS) data-right=(at) { "Compare above" } }
        }
    })
}

fn measured(effects: &Effects, cost: &Cost, (relative_mse, delta_e): (f64, &DeltaE), wrong: Estimate) -> Markup {
    let with = &effects.with;
    let share = 1.0 - cost.seconds / with.seconds;
    let change = if share >= 0.0 { format!("{} less", percent(share)) } else { format!("{} more", percent(-share)) };
    html! {
        table.figures { tbody {
            tr { th { "time" } td { (time(with.seconds)) " → " (time(cost.seconds)) " (" (change) ")" } }
            tr { th { "memory" } td { (bytes(with.memory_bytes)) " → " (bytes(cost.memory_bytes)) } }
            tr { th { "difference" } td { "ΔE " (format!("{:.2}", delta_e.mean)) ", 95 %: " (format!("{:.1}", delta_e.p95)) "; relMSE " (short(relative_mse)) } }
            tr { th { "error" } td { (typical(effects.wrong.value)) " → " (typical(wrong.value)) } }
        } }
    }
}

fn method(report: &Report) -> Markup {
    let reference = &report.reference;
    let percent_of = |share: f64| percent(share);
    html! {
        section {
            h2 { "How it was measured" }
            p {
                strong { "Reference: " }
                @match reference.origin {
                    "given" => { (reference.because) ". " }
                    origin => {
                        "by " (title_of(origin)) ": " (reference.because) "; two halves with seeds of their own, " (reference.passes) " passes in "
                        (time(reference.seconds)) ". "
                    }
                }
                "Its own noise is " (typical(reference.relative_variance)) " (relMSE " (short(reference.relative_variance))
                ") and is taken off every error, pixel by pixel; errors that do not stand clear of it by three standard errors are left out of plots and fits. "
                @if reference.origin == "photon" {
                    "Its kernels have a tenth of the scene's area, and so a tenth of the bias, which cannot be taken off: it claims a bias of "
                    (typical(reference.relative_bias_square)) ". "
                }
            }
            p { strong { "Smooth regions: " } (report.smooth_rule) "." }
            p {
                strong { "Time: " } "of " (time(report.budget_seconds)) " asked for, renders took " (time(report.spent_seconds)) ": "
                (percent_of(SHARES.trial)) " to try out who renders the reference, " (percent_of(SHARES.reference)) " the reference, "
                (percent_of(SHARES.photon_curve + SHARES.path_curve)) " error against time, " (percent_of(SHARES.sweep)) " the sweep, "
                (percent_of(SHARES.effects)) " effects. The film is as large as that allows, at most 65,536 pixels. Measuring errors is not counted."
            }
            p { strong { "Memory " } "is that of film, scene and photons, by the number of photons kept in a pass; the system tells only the peak of the whole process." }
            p.soft { (report.scene) ", abbe " (report.version) ". The same figures stand in study.json and in CSV files beside this page." }
        }
    }
}

/// Means of squares of pixels, so that a picture is at most [`THUMBNAIL`] wide.
fn shrunk(picture: &Picture) -> Picture {
    let step = picture.width.div_ceil(THUMBNAIL);
    let (width, height) = ((picture.width / step).max(1), (picture.height / step).max(1));
    let mut small = Picture::black(width, height);
    for (i, xyz) in small.xyz.iter_mut().enumerate() {
        let (left, top) = (i % width * step, i / width * step);
        let square = (top..(top + step).min(picture.height)).flat_map(|y| (left..left + step).map(move |x| (x, y)));
        let inside: Vec<usize> =
            square.filter(|(x, _)| *x < picture.width).map(|(x, y)| y * picture.width + x).collect();
        *xyz = [0, 1, 2].map(|c| inside.iter().map(|&i| picture.xyz[i][c]).sum::<f64>() / inside.len() as f64);
    }
    small
}

fn slope(fit: Option<super::fit::Fit>) -> String {
    fit.map_or("too few points".to_string(), |fit| fit.words())
}

/// The square root of a relative mean square error, in percent.
fn typical(relative_mse: f64) -> String {
    if relative_mse.is_nan() { "unknown".to_string() } else { percent(relative_mse.max(0.0).sqrt()) }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
}

/// A relative mean square error with two digits.
fn short(relative_mse: f64) -> String {
    if !relative_mse.is_finite() {
        return "unknown".to_string();
    }
    let exponent = if relative_mse > 0.0 { relative_mse.log10().floor() as i32 } else { 0 };
    let unit = 10.0_f64.powi(exponent - 1);
    let digits = (relative_mse / unit).round();
    if exponent >= -3 {
        format!("{}", (digits * unit * 1e6).round() / 1e6)
    } else {
        format!("{}·{}", digits / 10.0, power_of_ten(exponent))
    }
}

fn passes(count: u64) -> String {
    format!("{count} pass{}", if count == 1 { "" } else { "es" })
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 0.995 => format!("{:.0} ms", 1000.0 * s),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s if s < 5940.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

fn bytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 * 1e-6)
}
