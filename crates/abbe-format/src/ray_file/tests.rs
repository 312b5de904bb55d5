//! Ray files made here, byte by byte, and damaged ones.

use super::*;
use abbe_spectra::math::random::{Purpose, Seed, Stream};

/// A TM-25 file. The flags are those of the flux in W, wavelengths, flux in lm, Stokes vectors,
/// tristimulus values and spectrum indices.
struct Tm25<'a> {
    kind: i32,
    single_nm: f32,
    tables: &'a [&'a [(f32, f32)]],
    flags: [i32; 6],
    items: usize,
    rays: &'a [&'a [f32]],
}

impl Tm25<'_> {
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"TM25".to_vec();
        let mut put = |number: i32| bytes.extend(number.to_le_bytes());
        put(2013);
        put(0);
        [0.0_f32, 1.0].iter().for_each(|flux| put(flux.to_bits() as i32));
        put(self.rays.len() as i32);
        put(0);
        (0..8).for_each(|_| put(0));
        put(self.kind);
        [self.single_nm, 380.0, 780.0].iter().for_each(|nm| put(nm.to_bits() as i32));
        put(self.tables.len() as i32);
        put(self.items as i32);
        put(32);
        (0..42).for_each(|_| put(0));
        [1, 1].iter().chain(&self.flags).for_each(|flag| put(*flag));
        (0..9000).for_each(|_| put(0));
        let mut words = 0;
        for table in self.tables {
            put(table.len() as i32);
            table.iter().for_each(|(nm, value)| [nm, value].iter().for_each(|it| put(it.to_bits() as i32)));
            words += 1 + 2 * table.len();
        }
        (0..words.next_multiple_of(8) - words + 128 * self.items + 8).for_each(|_| put(0));
        self.rays.iter().flat_map(|ray| ray.iter()).for_each(|number| put(number.to_bits() as i32));
        bytes
    }
}

const WATTS: [i32; 6] = [1, 0, 0, 0, 0, 0];
const WATTS_ONLY: Tm25<'_> = Tm25 {
    kind: 0,
    single_nm: f32::NAN,
    tables: &[],
    flags: WATTS,
    items: 0,
    rays: &[&[1.0, 2.0, -3.0, 0.0, 0.0, 1.0, 0.25], &[0.0, 0.0, 0.0, 0.6, 0.0, 0.8, 0.5]],
};

fn parsed(bytes: &[u8]) -> Result<RayFile> {
    parse(bytes, bytes.len() as u64)
}

fn message(bytes: &[u8]) -> String {
    parsed(bytes).unwrap_err().to_string()
}

#[test]
fn points_are_in_millimetres_and_flux_in_watts() {
    let file = parsed(&WATTS_ONLY.bytes()).unwrap();
    assert_eq!((file.unit, file.groups.len(), file.notes.len()), (FluxUnit::Watt, 1, 0));
    let RayGroup { spectrum, rays } = &file.groups[0];
    assert_eq!(*spectrum, RaySpectrum::Unknown);
    let origin = glam::Vec3::new(0.001, 0.002, -0.003);
    assert_eq!(rays[0], EmittedRay { origin, direction: glam::Vec3::Z, flux: 0.25 });
    assert!(rays[1].direction.distance(glam::Vec3::new(0.6, 0.0, 0.8)) < 1e-6 && rays[1].flux == 0.5);
}

/// The spectra end at a multiple of 32 bytes, and additional columns follow the known ones.
#[test]
fn rays_follow_spectra_and_names_of_columns() {
    let table: &[(f32, f32)] = &[(400.0, 0.0), (500.0, 100.0), (600.0, 50.0)];
    let ray = [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 99.0];
    let file = Tm25 { kind: 3, tables: &[table], items: 1, rays: &[&ray], ..WATTS_ONLY };
    let group = &parsed(&file.bytes()).unwrap().groups[0];
    assert_eq!(group.spectrum, RaySpectrum::Table(vec![(400.0, 0.0), (500.0, 100.0), (600.0, 50.0)]));
    assert_eq!(group.rays[0].flux, 2.0);
}

#[test]
fn each_spectrum_has_its_rays() {
    let [blue, red]: [&[(f32, f32)]; 2] = [&[(440.0, 1.0), (460.0, 1.0)], &[(610.0, 1.0), (620.0, 1.0)]];
    let ray = |flux: f32, table: f32| [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, flux, table];
    let rays = [ray(1.0, 2.0), ray(2.0, 1.0), ray(4.0, 2.0)];
    let rays: Vec<&[f32]> = rays.iter().map(|ray| &ray[..]).collect();
    let file = Tm25 { kind: 4, tables: &[blue, red], flags: [1, 0, 0, 0, 0, 1], rays: &rays, ..WATTS_ONLY };
    let groups = parsed(&file.bytes()).unwrap().groups;
    let flux = |group: &RayGroup| group.rays.iter().map(|ray| ray.flux).sum::<f32>();
    assert_eq!(groups.iter().map(flux).collect::<Vec<_>>(), [2.0, 5.0]);
    let wrong = Tm25 { rays: &[&ray(1.0, 3.0)], ..file };
    assert!(message(&wrong.bytes()).contains("from 1 to 2"), "{}", message(&wrong.bytes()));
}

/// Few wavelengths stay lines. Many form groups, with the flux and the mean wavelength of their
/// rays.
#[test]
fn rays_with_their_own_wavelengths_form_groups() {
    let ray = |nm: f32| [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, nm];
    let file = |count: usize, nm: &dyn Fn(usize) -> f32| {
        let rays: Vec<[f32; 8]> = (0..count).map(|number| ray(nm(number))).collect();
        let rays: Vec<&[f32]> = rays.iter().map(|ray| &ray[..]).collect();
        let file = Tm25 { kind: 2, flags: [1, 1, 0, 0, 0, 0], rays: &rays, ..WATTS_ONLY };
        parsed(&file.bytes()).unwrap().groups
    };
    let lines = file(6, &|number| [450.0, 550.0, 650.0][number % 3]);
    let nm = [450.0, 550.0, 650.0].map(RaySpectrum::Line);
    assert_eq!(lines.iter().map(|group| group.spectrum.clone()).collect::<Vec<_>>(), nm);
    let groups = file(4000, &|number| 400.0 + 0.07 * number as f32);
    assert_eq!(groups.iter().map(|group| group.rays.len()).collect::<Vec<_>>(), [500; 8]);
    for (number, group) in groups.iter().enumerate() {
        let RaySpectrum::Table(table) = &group.spectrum else { panic!("{group:?}") };
        let (flux, sum) = table.iter().fold((0.0, 0.0), |(flux, sum), (nm, value)| (flux + value, sum + nm * value));
        let mean = 400.0 + 0.07 * (500.0 * number as f64 + 249.5);
        assert!((flux - 500.0).abs() < 1e-6 && (sum / flux - mean).abs() < 1e-3, "{}", sum / flux);
    }
}

#[test]
fn damaged_files_are_named_by_their_fault() {
    let good = WATTS_ONLY.bytes();
    let changed = |at: usize, value: i32| {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        message(&bytes)
    };
    assert!(changed(4, 1999).contains("version 1999"));
    assert!(changed(20, 3).contains("3 rays of 7 numbers"), "{}", changed(20, 3));
    assert!(changed(60, 7).contains("at byte 60: 7"), "{}", changed(60, 7));
    assert!(changed(264, 0).contains("no flux"), "{}", changed(264, 0));
    let direction = good.len() - 8;
    assert!(changed(direction, 3.0_f32.to_bits() as i32).contains("ray 2: its direction"));
    assert!(changed(good.len() - 4, f32::NAN.to_bits() as i32).contains("ray 2: its flux is NaN"));
    assert!(message(&good[..1000]).contains("ends after 1000 bytes"), "{}", message(&good[..1000]));
    assert!(message(b"lamp").contains("unknown kind"));
    assert!(message(b"").contains("unknown kind"));
}

fn zemax(unit: i32, format: i32, flux: i32, rays: &[&[f32]]) -> Vec<u8> {
    let mut bytes = [1010, rays.len() as i32].iter().flat_map(|it| it.to_le_bytes()).collect::<Vec<u8>>();
    bytes.extend([b'x'; 100]);
    let mut put = |number: i32| bytes.extend(number.to_le_bytes());
    [1.0_f32, 1.0, 0.55, 0.0, 0.0, 0.0, 0.0].iter().for_each(|it| put(it.to_bits() as i32));
    put(unit);
    (0..13).for_each(|_| put(0));
    [format, flux, 0, 0].iter().for_each(|it| put(*it));
    rays.iter().flat_map(|ray| ray.iter()).for_each(|it| put(it.to_bits() as i32));
    bytes
}

#[test]
fn source_files_of_zemax_are_read_in_their_units() {
    let ray = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0];
    let file = parsed(&zemax(1, 0, 1, &[&ray])).unwrap();
    assert_eq!((file.unit, file.groups[0].rays[0].origin.x), (FluxUnit::Lumen, 0.0254));
    let RaySpectrum::Line(nm) = file.groups[0].spectrum else { panic!("{file:?}") };
    assert!((nm - 550.0).abs() < 1e-4, "{nm}");
    let with_wavelength = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0, 0.633];
    let file = parsed(&zemax(4, 2, 0, &[&with_wavelength])).unwrap();
    let RaySpectrum::Line(nm) = file.groups[0].spectrum else { panic!("{file:?}") };
    assert!((nm - 633.0).abs() < 1e-4 && file.groups[0].rays[0].origin.x == 0.001, "{nm}");
    assert!(message(&zemax(9, 0, 0, &[&ray])).contains("unit of length"));
    assert!(message(&zemax(4, 1, 0, &[&ray])).contains("format 1"));
}

#[test]
fn text_files_of_zemax_are_read() {
    let file = parsed(b"2 2\n1 0 0 0 0 1 0.5\n0 0 0 0.6 0 0.8 1.5\n").unwrap();
    assert_eq!(file.groups[0].rays.iter().map(|ray| ray.flux).collect::<Vec<_>>(), [0.5, 1.5]);
    assert_eq!(file.groups[0].rays[0].origin.x, 0.01);
    let error = message(b"2 4\n1 0 0 0 0 1 0.5\n0 0 0 0.6 0 1.5\n");
    assert!(error.contains('3') && error.contains("seven numbers"), "{error}");
    assert!(message(b"3 4\n1 0 0 0 0 1 0.5\n").contains("the 3 rays"));
}

/// Files with random bytes changed, cut off or doubled are read or refused.
#[test]
fn mutations_cause_no_panic() {
    let mut stream = Stream::new(Seed::new(9), Purpose::SurveyPhoton, 0, 0);
    let table: &[(f32, f32)] = &[(400.0, 0.0), (500.0, 100.0)];
    let with_table = Tm25 { kind: 3, tables: &[table], ..WATTS_ONLY };
    let ray = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 3.0];
    let text = b"2 2\n1 0 0 0 0 1 0.5\n0 0 0 0.6 0 0.8 1.5\n".to_vec();
    for good in [with_table.bytes(), zemax(1, 0, 1, &[&ray]), text] {
        // Most of a TM-25 file is descriptions.
        let places: Vec<usize> = (0..good.len()).filter(|&at| !(288..36_288).contains(&at)).collect();
        let mut read = 0;
        for _ in 0..300 {
            let mut bytes = good.clone();
            for _ in 0..1 + (stream.uniform() * 3.0) as usize {
                bytes[places[(stream.uniform() * places.len() as f64) as usize]] = (stream.uniform() * 256.0) as u8;
            }
            if stream.uniform() < 0.2 {
                bytes.truncate((stream.uniform() * bytes.len() as f64) as usize);
            }
            read += usize::from(parsed(&bytes).is_ok());
        }
        assert!(read > 0 && read < 300, "{read}");
    }
}
