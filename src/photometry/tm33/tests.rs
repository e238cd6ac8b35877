//! Tests of TM-33 files: closed forms, round trips, and damaged files.

use super::super::clock::Moment;
use super::super::{ies, ldt};
use super::*;
use crate::error::ErrorKind;
use crate::photometry::Luminaire;
use std::f64::consts::PI;

const NOW: Moment = Moment(1_735_689_599);

/// A TM-33-18 file of a luminaire with the intensities `points`. `extra` holds its emission areas.
fn file(points: &str, extra: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<IESTM33>\n<Version>1.0</Version>\n<Header>\n<Manufacturer>Works\n &amp; Co</Manufacturer>\n\
         <Description> Troffer\n</Description>\n<Laboratory>L</Laboratory>\n<ReportNumber>1</ReportNumber>\n\
         <ReportDate>2020-01-01</ReportDate>\n</Header>\n<Luminaire>\n<Dimensions><Length>1.3</Length><Width>0.7</Width>\
         <Height>0.1</Height></Dimensions>\n<NumEmitter>1</NumEmitter>\n</Luminaire>\n<Equipment><Gonioradiometer>\
         <Type>IES_C</Type></Gonioradiometer></Equipment>\n<Emitter>\n<Quantity>2</Quantity>\n<Description>E</Description>\n\
         <RatedLumens>1500</RatedLumens>\n<InputWattage>35.4</InputWattage>\n<ColorTemperature><FixedCCT>4000</FixedCCT>\
         </ColorTemperature>\n<ColorRendering><CIE_CRI><Ra>92</Ra><R9>85</R9></CIE_CRI></ColorRendering>\n<LuminousData>\n\
         <LuminousIntensity>\n<AbsolutePhotometry>false</AbsolutePhotometry>\n{points}</LuminousIntensity>\n\
         <LuminousFlux>1000</LuminousFlux>\n</LuminousData>\n{extra}</Emitter>\n</IESTM33>\n"
    )
}

fn points(list: &[(f64, f64, f64)]) -> String {
    list.iter().map(|(h, v, value)| format!("<IntData h=\"{h}\" v=\"{v}\">{value}</IntData>\n")).collect()
}

/// A quarter of a symmetric distribution, in three planes: (horizontal angle, vertical angle, intensity).
const QUARTER: [(f64, f64, f64); 6] = [
    (0.0, 0.0, 100.0),
    (0.0, 90.0, 10.0),
    (45.0, 0.0, 100.0),
    (45.0, 90.0, 20.0),
    (90.0, 0.0, 100.0),
    (90.0, 90.0, 30.0),
];

#[test]
fn header_emitter_and_symmetry_are_read() {
    let l = read(file(&points(&QUARTER), "").as_bytes()).unwrap();
    assert_eq!((l.name.as_str(), l.manufacturer.as_str()), ("Troffer", "Works & Co"));
    assert_eq!((l.lamp_flux, l.watts, l.temperature, l.rendering), (3000.0, 35.4, 4000.0, 92.0));
    assert_eq!((l.size, l.opening()), ([0.0; 3], None));
    assert_eq!(l.planes, [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0]);
    for (c, want) in [(0.0, 10.0), (135.0, 20.0), (270.0, 30.0), (337.5, 15.0)] {
        assert!((l.intensity(c, 90.0) - want).abs() < 1e-12, "{c}");
    }
    // The intensities may be listed in any order. At a pole, one intensity suffices for all planes.
    let mut shuffled = QUARTER;
    shuffled.reverse();
    assert_eq!(read(file(&points(&shuffled), "").as_bytes()).unwrap(), l);
    let lean: Vec<_> = QUARTER.into_iter().filter(|(h, v, _)| *v > 0.0 || *h == 45.0).collect();
    assert_eq!(read(file(&points(&lean), "").as_bytes()).unwrap(), l);
    // Test the factors on the intensities, absolute photometry, and the text encodings.
    let absolute = file(&points(&QUARTER), "")
        .replace("ry>false", "ry>true")
        .replace("</AbsolutePhotometry>", "</AbsolutePhotometry><Multiplier>2.5</Multiplier>")
        .replace("<InputWattage>", "<BallastFactor>0.5</BallastFactor><InputWattage>");
    let found = read(absolute.as_bytes()).unwrap();
    assert_eq!((found.lamp_flux, found.intensity(0.0, 0.0)), (0.0, 125.0));
    let wide: Vec<u8> = "\u{feff}".encode_utf16().chain(absolute.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert_eq!(read(&wide).unwrap(), found);
    let latin = absolute.replace("Troffer", "Lampe für Räume");
    let bytes: Vec<u8> = latin.chars().map(|c| c as u8).collect();
    assert_eq!(read(&bytes).unwrap().name, "Lampe für Räume");
}

/// The flux of a Lambertian emitter is `π` times its intensity along the axis. Writing the luminaire to a file and
/// reading the file keeps the flux.
#[test]
fn the_flux_of_a_cosine_emitter_is_a_closed_form() {
    let list: Vec<_> = (0..=90).map(|i| (0.0, f64::from(i), 100.0 * f64::from(i).to_radians().cos())).collect();
    let l = read(file(&points(&list), "").as_bytes()).unwrap();
    assert!((l.flux() / (100.0 * PI) - 1.0).abs() < 1e-4, "{}", l.flux());
    // Two equal emitters give twice the flux, twice the power, and twice the intensity in any direction.
    let text = file(&points(&list), "");
    let emitter = &text[text.find("<Emitter>").unwrap()..text.find("</IESTM33>").unwrap()];
    let two = read(text.replace("</IESTM33>", &format!("{emitter}</IESTM33>")).as_bytes()).unwrap();
    assert!((two.flux() / l.flux() - 2.0).abs() < 1e-5 && two.watts == 70.8 && two.temperature == 4000.0);
    assert_eq!(read_file(text.replace("</IESTM33>", &format!("{emitter}</IESTM33>")).as_bytes()).unwrap().emitters, 2);
    assert!((two.intensity(77.0, 33.0) - 2.0 * l.intensity(0.0, 33.0)).abs() < 1e-9);
}

/// A box of 0.6 x 1.2 x 0.1 m. Two areas form the two halves of its lower face, and two of its sides have luminous
/// strips of different heights.
#[test]
fn emission_areas_make_the_opening() {
    let area = |name: &str, sizes: [(&str, f64); 2], offset: f64| {
        let [(a, x), (b, y)] = sizes;
        format!("<{name}><{a}>{x}</{a}><{b}>{y}</{b}><{a}Offset>{offset}</{a}Offset><{b}Offset>0</{b}Offset></{name}>")
    };
    let below = [-0.3, 0.3].map(|at| area("BottomArea", [("Length", 0.6), ("Width", 0.6)], at)).concat();
    let text = format!(
        "<EmissionAreas><BottomFace><NumberBottom>2</NumberBottom>{below}</BottomFace><C0Face>{}</C0Face><C90Face>{}\
         </C90Face></EmissionAreas>",
        area("C0Area", [("Length", 1.2), ("Height", 0.1)], 0.0),
        area("C90Area", [("Width", 0.6), ("Height", 0.05)], 0.0)
    );
    let l = read(file(&points(&QUARTER), &text).as_bytes()).unwrap();
    assert_eq!((l.size, l.side_heights), ([0.6, 1.2, 0.1], Some([0.1, 0.05, 0.0, 0.0])));
    let disc = "<EmissionAreas><BottomFace><BottomArea><Length>0.4</Length><Width>0.4</Width><Circular>true</Circular>\
                </BottomArea></BottomFace></EmissionAreas>";
    assert_eq!(read(file(&points(&QUARTER), disc).as_bytes()).unwrap().size, [-0.4, -0.4, 0.0]);
}

/// The opening of two emitters is the bounding box of the areas of both. Areas of emitters without luminous intensities
/// are ignored.
#[test]
fn emission_areas_of_all_emitters_make_the_opening() {
    let areas = |face: &str, length: f64, offset: f64, more: &str| {
        format!(
            "<EmissionAreas><{face}Face><{face}Area><Length>{length}</Length><Width>0.3</Width><LengthOffset>{offset}\
             </LengthOffset>{more}</{face}Area></{face}Face></EmissionAreas>"
        )
    };
    let with = |first: &str, second: &str| {
        let text = file(&points(&QUARTER), first);
        let emitter = text[text.find("<Emitter>").unwrap()..text.find("</IESTM33>").unwrap()].replace(first, second);
        let dark = emitter.replace("LuminousData", "PhotonData").replace("0.3<", "9<");
        read(text.replace("</IESTM33>", &format!("{emitter}{dark}</IESTM33>")).as_bytes()).unwrap()
    };
    // On one face, the areas extend from -0.9 to -0.1 and from 0.3 to 0.9. Then one area lies on the lower face and one
    // on the upper face.
    let [left, right] = [areas("Bottom", 0.8, -0.5, ""), areas("Bottom", 0.6, 0.6, "")];
    let both = with(&left, &right);
    assert!((both.size[1] - 1.8).abs() < 1e-12 && both.size[0] == 0.3 && both.size[2] == 0.0, "{:?}", both.size);
    assert_eq!(with(&left, &areas("Top", 1.5, 0.0, "")).size, [0.3, 1.5, 0.0]);
    // Two equal discs in one place give a disc; a disc and a rectangle give a rectangle.
    let round = areas("Bottom", 0.3, 0.0, "<Circular>true</Circular>");
    assert_eq!(with(&round, &round).size, [-0.3, -0.3, 0.0]);
    assert_eq!(with(&round, &areas("Bottom", 0.3, 0.0, "")).size, [0.3, 0.3, 0.0]);
    assert_eq!(with(&areas("Bottom", 0.3, 0.0, " "), &round).size, [0.3, 0.3, 0.0]);
    assert_eq!(with(&left, "<!-- none -->").size, [0.3, 0.8, 0.0]);
}

/// A distribution that is symmetric about the plane through 90 and 270 is stored as one of its halves: from 90 to 270,
/// or from 270 through 0 to 90.
#[test]
fn both_halves_about_c90_are_unfolded() {
    let symmetric = |values: &[(f64, f64)]| {
        let list: Vec<_> = values.iter().flat_map(|(c, v)| [(*c, 0.0, 50.0), (*c, 90.0, *v)]).collect();
        let stated = "</AbsolutePhotometry><Symm>Symm_Bi_90</Symm>";
        read(file(&points(&list), "").replace("</AbsolutePhotometry>", stated).as_bytes())
    };
    let want = symmetric(&[(90.0, 4.0), (120.0, 3.0), (180.0, 1.0), (240.0, 6.0), (270.0, 7.0)]).unwrap();
    assert_eq!(want.planes, [0.0, 60.0, 90.0, 120.0, 180.0, 240.0, 270.0, 300.0]);
    let before = [(270.0, 7.0), (300.0, 6.0), (0.0, 1.0), (60.0, 3.0), (90.0, 4.0)];
    assert_eq!(symmetric(&before).unwrap(), want);
    // The plane at 0 may also be stated at 360, or at both angles.
    let at_360 = before.map(|(c, v)| (if c == 0.0 { 360.0 } else { c }, v));
    assert_eq!(symmetric(&at_360).unwrap(), want);
    assert_eq!(symmetric(&[&before[..], &[(360.0, 1.0)]].concat()).unwrap(), want);
    for (c, intensity) in [(0.0, 1.0), (180.0, 1.0), (150.0, 2.0), (225.0, 4.75), (315.0, 4.75)] {
        assert!((want.intensity(c, 90.0) - intensity).abs() < 1e-12, "{c}");
    }
    // If a file states the full circle, its planes stay as they are. A half without the planes at 90 and 270 is
    // refused.
    let whole = symmetric(&[(0.0, 1.0), (90.0, 4.0), (180.0, 1.0), (270.0, 7.0)]).unwrap();
    assert_eq!(whole.planes, [0.0, 90.0, 180.0, 270.0]);
    let error = symmetric(&[(0.0, 1.0), (60.0, 3.0), (300.0, 6.0)]).unwrap_err();
    assert!(
        error.message.contains("the symmetry is Symm_Bi_90, but the horizontal angles go from 0 to 300"),
        "{error}"
    );
}

/// Photometry of a type other than C is refused, at whichever place the file states the type.
#[test]
fn only_photometry_of_type_c_is_read() {
    let good = file(&points(&QUARTER), "");
    let want = read(good.as_bytes()).unwrap();
    let places = ["<Type>IES_C</Type>", "<LuminousData>", "<LuminousIntensity>"];
    for kind in ["", "C", "CIE_C", "IES _ C", "Type C", "type_c"] {
        assert_eq!(read(good.replace("IES_C", kind).as_bytes()).unwrap(), want, "{kind}");
    }
    for kind in ["A", "CIE_A", "CIE _ B", "IES_A", "IES_B", "TypeB", "CUSTOM"] {
        for place in places {
            let stated = format!("{place}<PhotometryType>{kind}</PhotometryType>");
            let text = if place == places[0] { good.replace("IES_C", kind) } else { good.replace(place, &stated) };
            let error = read(text.as_bytes()).unwrap_err();
            let says = format!("the photometry has the type \"{kind}\"; only type C is read");
            assert!(error.kind == ErrorKind::Unsupported && error.message.contains(&says), "{error}");
        }
    }
    let other = "<LuminaireOpticalData><Emitter><IntensityDistribution><PhotometryType>B</PhotometryType>\
                 <IntensityData horz=\"0\" vert=\"0\">50</IntensityData></IntensityDistribution></Emitter>\
                 </LuminaireOpticalData>";
    says(other, "line 1: the photometry has the type \"B\"");
    assert!(read(other.replace(">B<", ">C<").as_bytes()).is_ok());
}

/// A distribution without symmetry that also shines upwards.
fn uneven(size: [f64; 3], side_heights: Option<[f64; 4]>) -> Luminaire {
    Luminaire {
        name: "A <lamp> & \"more\" für".into(),
        manufacturer: "Werk".into(),
        gammas: vec![0.0, 45.5, 90.0, 135.0, 180.0],
        planes: vec![0.0, 30.0, 200.0],
        candela: (0..15).map(|i| f64::from(i * i) / 7.0).collect(),
        watts: 12.25,
        temperature: 3000.0,
        rendering: 90.0,
        side_heights,
        ..Luminaire::lambertian("", 1234.5, size)
    }
}

#[test]
fn written_files_are_read_back() {
    for (size, heights) in [
        ([0.0; 3], None),
        ([0.6, 1.2, 0.0], None),
        ([0.6, 1.2, 0.08], None),
        ([0.06, 1.19, 0.08], Some([0.08, 0.0, 0.08, 0.0])),
        ([1.2, 0.0, 0.3], None),
        ([-0.4, -0.4, 0.0], None),
        ([-0.4, -0.6, 0.0], None),
        ([-0.4, -0.4, 0.5], None),
        ([1.2, -0.026, -0.026], None),
        ([-0.026, 1.2, -0.026], None),
        ([-0.3, -0.4, -0.5], None),
    ] {
        let l = uneven(size, heights);
        let again = read(write(&l, NOW).unwrap().as_bytes()).unwrap();
        assert_eq!(again, l, "{size:?}");
        let down = Luminaire { side_heights: heights, ..Luminaire::lambertian("down", 800.0, size) };
        assert_eq!(read(write(&down, NOW).unwrap().as_bytes()).unwrap(), down, "{size:?}");
        let up = Luminaire { gammas: down.gammas.iter().map(|g| 180.0 - g).rev().collect(), ..down };
        let up = Luminaire { candela: up.candela.iter().rev().copied().collect(), lamp_flux: 0.0, ..up };
        assert_eq!(read(write(&up, NOW).unwrap().as_bytes()).unwrap(), up, "{size:?}");
    }
    // Luminaires read from IES and EULUMDAT files also keep their data when they are written as TM-33 and read back.
    let l = uneven([0.6, 1.2, 0.0], None);
    let of_ies = ies::read(ies::write(&l).unwrap().as_bytes()).unwrap();
    let back = read(write(&of_ies, NOW).unwrap().as_bytes()).unwrap();
    assert_eq!(ies::write(&back).unwrap(), ies::write(&l).unwrap());
    let of_ldt = ldt::read(ldt::write(&l).unwrap().as_bytes()).unwrap();
    let back = read(write(&of_ldt, NOW).unwrap().as_bytes()).unwrap();
    assert_eq!(ldt::write(&back).unwrap(), ldt::write(&of_ldt).unwrap());
    assert!(write(&Luminaire { candela: vec![f64::NAN; 15], ..l }, NOW).is_err());
}

/// Some tools write the root `LuminaireOpticalData` and other names of elements and attributes.
#[test]
fn files_of_other_tools_are_read() {
    let text = "<LuminaireOpticalData version=\"1.0\" xmlns=\"http://www.ies.org/tm-33\"><Header><CatalogNumber>N\
                </CatalogNumber></Header><Emitter><Quantity>1</Quantity><InputWatts>30</InputWatts><CCT>6500</CCT>\
                <ColorRendering><Ra>86</Ra></ColorRendering><IntensityDistribution><Metric>Radiant</Metric>\
                </IntensityDistribution><IntensityDistribution><Metric>Luminous</Metric>\
                <IntensityData horz=\"0\" vert=\"0\">50</IntensityData><IntensityData horz=\"0\" vert=\"90\">0\
                </IntensityData></IntensityDistribution></Emitter></LuminaireOpticalData>";
    let l = read(text.as_bytes()).unwrap();
    assert_eq!((l.name.as_str(), l.watts, l.temperature, l.rendering), ("N", 30.0, 6500.0, 86.0));
    assert_eq!(l.intensity(200.0, 45.0), 25.0);
    // If the file states the rated flux of its two lamps, the intensities are in candela per 1000 lm.
    let relative = text.replace("<Quantity>1</Quantity>", "<Quantity>2</Quantity><RatedLumens>3000</RatedLumens>");
    let l = read(relative.as_bytes()).unwrap();
    assert_eq!((l.intensity(200.0, 45.0), l.lamp_flux), (75.0, 3000.0));
}

#[track_caller]
fn says(text: &str, what: &str) {
    let error = read(text.as_bytes()).unwrap_err();
    assert!(error.message.contains(what), "{error}");
}

#[test]
fn malformed_files_are_refused_with_the_line() {
    let good = file(&points(&QUARTER), "");
    says("", "line 1");
    says("<html></html>", "the root is \"html\"");
    says(&good.replace("IES_C", "CIE _ B"), "only type C");
    says(&good.replace("h=\"45\" v=\"90\"", "h=\"45\" v=\"80\""), "no intensity has the direction h = 0, v = 80");
    says(&good.replace("h=\"45\" v=\"90\"", "h=\"0\" v=\"90\""), "two intensities");
    says(&good.replace("h=\"45\" v=\"90\"", "h=\"45\" v=\"190\""), "line 31: v is 190; it must lie in [0, 180]");
    says(&good.replace("h=\"45\" v=\"90\"", "h=\"45\""), "no attribute v");
    says(&good.replace(">20<", ">NaN<"), "line 31: IntData is NaN");
    says(&good.replace(">20<", ">-1<"), "IntData is -1");
    says(&good.replace(">20<", ">many<"), "\"many\"");
    says(&good.replace(">35.4<", ">-5<"), "InputWattage is -5");
    says(
        &good.replace("</AbsolutePhotometry>", "</AbsolutePhotometry><NumberMeasured>7</NumberMeasured>"),
        "6 intensities",
    );
    says(
        &good.replace("</AbsolutePhotometry>", "</AbsolutePhotometry><NumberVert>9</NumberVert>"),
        "2 vertical angles",
    );
    says(&good.replace("</AbsolutePhotometry>", "</AbsolutePhotometry><Symm>Symm_None</Symm>"), "from 0 to 90");
    says(
        &good.replace("</AbsolutePhotometry>", "</AbsolutePhotometry><Symm>Symm_Odd</Symm>"),
        "Symm_Odd\"; Symm_None, Symm_Arbitrary, Symm_Bi_0, Symm_Bi_90, Symm_Quad and Symm_Full are read",
    );
    says(&good.replace("h=\"90\"", "h=\"80\""), "from 0 to 80");
    says(&file("", ""), "0 intensities");
    says(&good.replace("LuminousData", "PhotonData"), "no luminous intensities");
    assert_eq!(read(good.replace("LuminousData", "PhotonData").as_bytes()).unwrap_err().kind, ErrorKind::Unsupported);
    assert!(read(&[0xff, 0x00, 0x12]).is_err() && read(&[0xff, 0xfe, 0x00, 0xd8]).is_err());
    // Every truncated file gives an error without a panic.
    for end in 0..good.trim_end().len() {
        assert!(read(&good.as_bytes()[..end]).is_err(), "{end}");
    }
}

/// Entities, huge numbers of attributes and namespaces, and deeply nested elements are refused, or are read in little
/// memory.
#[test]
fn hostile_files_are_refused() {
    let bomb = "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><IESTM33>&b;</IESTM33>";
    says(bomb, "DTD");
    says("<IESTM33><!-- > --><a b='<=>' c=\"x\"/></IESTM33>", "line 1");
    let flood: String = (0..70).map(|i| format!(" a{i}=''")).collect();
    says(&format!("<IESTM33>\n<b{flood}/></IESTM33>"), "line 2: an element has 70 attributes");
    let spaces: String = (0..300).map(|i| format!("<a xmlns:n{i}='u{i}'/>")).collect();
    says(&format!("<IESTM33>{spaces}</IESTM33>"), "namespaces");
    let deep = "<a>".repeat(300_000) + &"</a>".repeat(300_000);
    says(&format!("<IESTM33>{deep}</IESTM33>"), "no luminous intensities");
    says(&format!("<IESTM33>{}</IESTM33>", "<a/>".repeat(2_200_000)), "more than");
    assert!(read(&vec![b'<'; super::super::xml::MAX_BYTES + 1]).unwrap_err().message.contains("at most"));
}
