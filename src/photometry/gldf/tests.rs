//! Tests of GLDF containers: round trips, variants and emitters, and damaged or hostile archives.

use super::super::clock::Moment;
use super::super::luminaire::Luminaire;
use super::super::{ies, ldt, tm33};
use super::*;
use crate::error::{Error, ErrorKind};
use miniz_oxide::deflate::compress_to_vec;
use rawzip::{CompressionMethod, DataDescriptorOutput, ZipArchiveWriter};
use std::io::Write;

const NOW: Moment = Moment(1_735_689_599);

/// Returns a ZIP archive of the given files (name, content).
fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut out);
    for (i, (name, bytes)) in files.iter().enumerate() {
        // Every second file is stored without compression.
        let method = if i % 2 == 0 { CompressionMethod::DEFLATE } else { CompressionMethod::STORE };
        let (mut entry, _) = archive.new_file(*name).compression_method(method).start().unwrap();
        let packed = if i % 2 == 0 { compress_to_vec(bytes, 6) } else { bytes.to_vec() };
        entry.write_all(&packed).unwrap();
        entry.finish(DataDescriptorOutput::new(rawzip::crc32(bytes), bytes.len() as u64)).unwrap();
    }
    archive.finish().unwrap();
    out
}

fn lamp(flux: f64) -> Luminaire {
    Luminaire { watts: 20.0, ..Luminaire::lambertian("lamp", flux, [0.6, 1.2, 0.0]) }
}

fn name(text: &str) -> String {
    format!("<Name><Locale language=\"de\">{text}-de</Locale><Locale language=\"en\">{text}</Locale></Name>")
}

/// Emitters of all kinds that are read, a sensor, and the emitters in `extra`.
fn emitters(extra: &str) -> String {
    let fixed = |id: &str, photometry: &str, flux: u32, behaviour: &str| {
        format!(
            "<Emitter id=\"{id}\"><FixedLightEmitter{behaviour}><PhotometryReference photometryId=\"{photometry}\"/>\
             <LightSourceReference fixedLightSourceId=\"led\"/><RatedLuminousFlux>{flux}</RatedLuminousFlux>\
             </FixedLightEmitter></Emitter>"
        )
    };
    let parts: [&str; 6] = [
        &fixed("same", "pl", 1000, ""),
        &fixed("double", "pi", 2000, " emergencyBehaviour=\"Combined\""),
        &fixed("emergency", "pl", 50, " emergencyBehaviour=\"EmergencyOnly\""),
        "<Emitter id=\"changeable\"><ChangeableLightEmitter><PhotometryReference photometryId=\"pt\"/><EquipmentReference \
         equipmentId=\"eq\"/></ChangeableLightEmitter></Emitter>",
        "<Emitter id=\"channels\"><MultiChannelLightEmitter><LightSourceReference multiChannelLightSourceId=\"multi\"/>\
         </MultiChannelLightEmitter></Emitter><Emitter id=\"sensor\"><SensorEmitter><SensorReference sensorId=\"s\"/>\
         </SensorEmitter></Emitter>",
        extra,
    ];
    parts.concat()
}

/// Variants of the product, each of which refers to some of the emitters; `extra` holds a further variant.
fn variants(extra: &str) -> String {
    let reference = |id: &&str| {
        format!(
            "<EmitterReference emitterId=\"{id}\"><EmitterObjectExternalName>x</EmitterObjectExternalName>\
             </EmitterReference>"
        )
    };
    let variant = |id: &str, text: &str, emitters: &[&str]| {
        let list: String = emitters.iter().map(reference).collect();
        format!(
            "<Variant id=\"{id}\">{}<Geometry><ModelGeometryReference geometryId=\"g\">{list}</ModelGeometryReference>\
             </Geometry></Variant>",
            name(text)
        )
    };
    let parts: [&str; 6] = [
        &variant("v-1", "One", &["same"]),
        &variant("v-2", "Two", &["same", "double", "emergency", "sensor"]),
        &variant("v-3", "Changeable", &["changeable"]),
        &variant("v-4", "Channels", &["channels"]),
        &variant("v-5", "Dark", &["emergency"]),
        extra,
    ];
    parts.concat()
}

/// A product with three kinds of photometry, all kinds of emitters, and variants that use them.
fn product(extra_emitter: &str, extra_variant: &str) -> String {
    let file = |id: &str, kind: &str, name: &str| {
        format!("<File id=\"{id}\" contentType=\"ldc/{kind}\" type=\"localFileName\">{name}</File>")
    };
    let photometry = |id: &str, file: &str| {
        format!("<Photometry id=\"{id}\"><PhotometryFileReference fileId=\"{file}\"/></Photometry>")
    };
    let source = "<ColorInformation><ColorRenderingIndex>90</ColorRenderingIndex><CorrelatedColorTemperature>3000\
                  </CorrelatedColorTemperature></ColorInformation>";
    let channel = |flux: u32| {
        format!(
            "<Channel type=\"Red\"><PhotometryReference photometryId=\"pl\"/><RatedLuminousFlux>{flux}\
             </RatedLuminousFlux></Channel>"
        )
    };
    [
        "<Root>\n<Header><Manufacturer>Works</Manufacturer></Header>\n<GeneralDefinitions><Files>",
        &[file("l", "eulumdat", "A.ldt"), file("i", "ies", "b.ies"), file("t", "iesxml", "c.xml")].concat(),
        "</Files>\n<Photometries>",
        &[photometry("pl", "l"), photometry("pi", "i"), photometry("pt", "t")].concat(),
        "</Photometries>\n<LightSources><FixedLightSource id=\"led\"><RatedInputPower>25</RatedInputPower>",
        source,
        "</FixedLightSource><ChangeableLightSource id=\"tube\"><RatedInputPower>10</RatedInputPower><RatedLuminousFlux>\
         400</RatedLuminousFlux></ChangeableLightSource><MultiChannelLightSource id=\"multi\"><RatedInputPower>33\
         </RatedInputPower>",
        source,
        "<Channels>",
        &[channel(100), channel(200)].concat(),
        "</Channels></MultiChannelLightSource></LightSources>\n<Equipments><Equipment id=\"eq\"><LightSourceReference \
         changeableLightSourceId=\"tube\" lightSourceCount=\"3\"/><RatedInputPower>32</RatedInputPower></Equipment>\
         </Equipments>\n<Emitters>",
        &emitters(extra_emitter),
        "</Emitters></GeneralDefinitions>\n<ProductDefinitions><ProductMetaData>",
        &name("Product"),
        "</ProductMetaData><Variants>\n",
        &variants(extra_variant),
        "</Variants></ProductDefinitions>\n</Root>",
    ]
    .concat()
}

/// A container with the description `product` and its photometry files. Each of these files has a flux of 1000 lm.
fn container(product: &str) -> Vec<u8> {
    let ldt = ldt::write(&lamp(1000.0)).unwrap();
    let ies = ies::write(&Luminaire { lamp_flux: 0.0, ..lamp(1000.0) }).unwrap();
    let xml = tm33::write(&lamp(1000.0), NOW).unwrap();
    archive(&[
        ("product.xml", product.as_bytes()),
        ("ldc/a.ldt", ldt.as_bytes()),
        ("ldc/b.ies", ies.as_bytes()),
        ("ldc/c.xml", xml.as_bytes()),
        ("geo/unused.l3d", b"PK"),
    ])
}

#[test]
fn variants_are_chosen_and_their_emitters_added_up() {
    let bytes = container(&product("", ""));
    let flux = |variant: Option<&str>| {
        let file = read(&bytes, variant).unwrap();
        assert_eq!(file.variants, 5);
        file.luminaire
    };
    let one = flux(None);
    assert_eq!((one.name.as_str(), one.manufacturer.as_str()), ("One", "Works"));
    assert_eq!((one.watts, one.temperature, one.rendering, one.lamp_flux), (25.0, 3000.0, 90.0, 1000.0));
    assert!((one.flux() - lamp(1000.0).flux()).abs() < 1e-9);
    for name in ["One", "One-de", "v-1", "0"] {
        assert_eq!(flux(Some(name)), one, "{name}");
    }
    // The rated flux scales the intensities: the second emitter has twice the flux of its photometry. Emergency lights
    // and sensors add no light.
    let two = flux(Some("Two"));
    assert_eq!(read(&bytes, Some("Two")).unwrap().emitters, 2);
    assert!((two.flux() / 3000.0 - 1.0).abs() < 1e-3, "{}", two.flux());
    assert_eq!((two.watts, two.temperature), (50.0, 3000.0));
    // Variant "v-3" has three lamps of 400 lm. The variant with index 3 has channels of 100 lm and 200 lm.
    let three = flux(Some("v-3"));
    assert!(
        (three.flux() / 1200.0 - 1.0).abs() < 1e-3 && (three.lamp_flux - 1200.0).abs() < 1e-9 && three.watts == 32.0
    );
    let four = flux(Some("3"));
    assert!((four.flux() / 300.0 - 1.0).abs() < 1e-3 && four.watts == 33.0, "{}", four.flux());
    assert_eq!((four.temperature, four.rendering), (3000.0, 90.0));
    // A variant without a name gets the name of the product.
    for name in ["", "<Name/>", "<Name><Locale language=\"en\">---</Locale></Name>"] {
        let geometry = "<Geometry><EmitterReference emitterId=\"same\"/></Geometry>";
        let unnamed = product("", &format!("<Variant id=\"v-6\">{name}{geometry}</Variant>"));
        assert_eq!(read(&container(&unnamed), Some("v-6")).unwrap().luminaire.name, "Product");
    }
    let error = read(&bytes, Some("Dark")).unwrap_err();
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains("normal operation"), "{error}");
    let error = read(&bytes, Some("Six")).unwrap_err();
    assert!(
        error.kind == ErrorKind::NotFound && error.message.contains("\"Six\"; there are 5: \"One\", \"Two\""),
        "{error}"
    );
}

#[test]
fn written_containers_are_read_back() {
    let uneven = Luminaire {
        name: "A <lamp> & \"more\" für".into(),
        manufacturer: "Werk".into(),
        gammas: vec![0.0, 45.5, 90.0, 135.0, 180.0],
        planes: vec![0.0, 30.0, 200.0],
        candela: (0..15).map(|i| f64::from(i * i) / 7.0).collect(),
        watts: 12.25,
        temperature: 3000.0,
        rendering: 90.0,
        lamp_flux: 0.0,
        side_heights: Some([0.08, 0.0, 0.08, 0.0]),
        ..Luminaire::lambertian("", 0.0, [0.06, 1.19, 0.08])
    };
    let sizes = [[0.0; 3], [-0.4, -0.4, 0.0], [-0.4, -0.4, 0.25], [0.6, 1.2, 0.0]];
    let lamps = sizes.map(|size| Luminaire::lambertian("panel", 3456.7, size));
    for l in lamps.into_iter().chain([uneven]) {
        // The container stores the intensities in a EULUMDAT file, so they equal the intensities that this file alone
        // gives.
        let of_ldt = ldt::read(ldt::write(&l).unwrap().as_bytes()).unwrap();
        let again = read(&write(&l, NOW).unwrap(), None).unwrap();
        assert_eq!((again.luminaire, again.variants), (of_ldt, 1));
    }
    assert_eq!(write(&lamp(1.0), NOW).unwrap(), write(&lamp(1.0), NOW).unwrap());
}

/// A variant without geometry has the emitter of the product if the product has only one emitter.
#[test]
fn a_single_emitter_needs_no_reference() {
    let l = lamp(1000.0);
    let text = product_of(&write(&Luminaire { size: [0.0; 3], ..l.clone() }, NOW).unwrap());
    let photometry = ldt::write(&l).unwrap();
    let geometry = &text[text.find("<Geometry>").unwrap()..text.find("</Variant>").unwrap()];
    let read_of = |text: &str| {
        read(&archive(&[("product.xml", text.as_bytes()), ("ldc/photometry.ldt", photometry.as_bytes())]), None)
    };
    let found = read_of(&text.replace(geometry, "<Geometry/>")).unwrap();
    assert_eq!((found.emitters, found.luminaire.size), (1, l.size));
    let two = text.replace(geometry, "").replace("<Emitters>", "<Emitters><Emitter id=\"other\"/>");
    assert_eq!(read_of(&two).unwrap_err().kind, ErrorKind::Unsupported);
}

/// The simple geometry replaces the opening of the photometry. If it states no luminous heights, the photometry's
/// heights stay.
#[test]
fn simple_geometry_makes_the_opening() {
    let read_with = |l: &Luminaire, photometry: &Luminaire, change: &dyn Fn(&str) -> String| {
        let text = change(&product_of(&write(l, NOW).unwrap()));
        let photometry = ldt::write(photometry).unwrap();
        let bytes = archive(&[("product.xml", text.as_bytes()), ("ldc/photometry.ldt", photometry.as_bytes())]);
        read(&bytes, None).unwrap().luminaire
    };
    let same = |text: &str| text.to_string();
    let without = |name: &'static str| {
        move |text: &str| {
            let (start, end) = (format!("<{name}>"), format!("</{name}>"));
            format!("{}{}", text.split_once(&start).unwrap().0, text.split_once(&end).unwrap().1)
        }
    };
    let with_size = |size: [f64; 3], side_heights| Luminaire { size, side_heights, ..lamp(1000.0) };
    let uneven = with_size([0.6, 1.2, 0.08], Some([0.08, 0.0, 0.08, 0.0]));
    let round = with_size([-0.4, -0.4, 0.1], None);
    let point = with_size([0.0; 3], None);
    let other = with_size([0.3, 0.5, 0.04], Some([0.04, 0.02, 0.04, 0.02]));
    for photometry in [&point, &other, &round] {
        for l in [&uneven, &round] {
            let found = read_with(l, photometry, &same);
            assert_eq!((found.size, found.side_heights), (l.size, l.side_heights));
        }
    }
    let no_heights = without("C-Heights");
    let found = read_with(&uneven, &other, &no_heights);
    assert_eq!((found.size, found.side_heights), ([0.6, 1.2, 0.04], other.side_heights));
    let found = read_with(&round, &other, &no_heights);
    assert_eq!((found.size, found.side_heights), ([-0.4, -0.4, 0.04], None));
    // If the geometry has no luminous face, the size and the heights of the photometry's opening stay.
    let found = read_with(&uneven, &other, &|text| no_heights(&without("RectangularEmitter")(text)));
    assert_eq!((found.size, found.side_heights), (other.size, other.side_heights));
    // A sphere is written as a cylinder, both in the geometry and in the EULUMDAT file.
    let sphere = with_size([-0.3, -0.3, -0.3], None);
    assert_eq!(read_with(&sphere, &sphere, &same).size, [-0.3, -0.3, 0.3]);
}

fn product_of(container: &[u8]) -> String {
    let container = container::Container::new(container).unwrap();
    String::from_utf8(container.file("product.xml", 1 << 20).unwrap()).unwrap()
}

/// Turning about the axis moves the planes and the opening; other turns are refused.
#[test]
fn emitters_are_turned_about_their_axis() {
    let l = Luminaire {
        gammas: vec![0.0, 90.0],
        planes: vec![0.0, 100.0, 180.0],
        candela: vec![5.0, 1.0, 5.0, 2.0, 5.0, 3.0],
        size: [0.6, 1.2, 0.08],
        side_heights: Some([0.08, 0.02, 0.0, 0.04]),
        ..lamp(1000.0)
    };
    // Take the description of a point luminaire: it has no simple geometry, which would replace the turned opening.
    let text = product_of(&write(&Luminaire { size: [0.0; 3], ..l.clone() }, NOW).unwrap());
    let with_text = |text: &str, l: &Luminaire, rotation: &str| {
        let text = text.replace("<FixedLightEmitter>", &format!("<FixedLightEmitter><Rotation>{rotation}</Rotation>"));
        let photometry = ldt::write(l).unwrap();
        read(&archive(&[("product.xml", text.as_bytes()), ("ldc/photometry.ldt", photometry.as_bytes())]), None)
    };
    let turned = |l: &Luminaire, rotation: &str| with_text(&text, l, rotation);
    let by = |l: &Luminaire, angle: f64| turned(l, &format!("<X>0</X><Y>360</Y><Z>{angle}</Z><G0>0</G0>"));
    let found = turned(&l, "<X>0</X><Y>360</Y><Z>60</Z><G0>30</G0>").unwrap().luminaire;
    assert_eq!(found, by(&l, 90.0).unwrap().luminaire);
    let alike = Luminaire { gammas: vec![0.0, 90.0], planes: vec![0.0], candela: vec![5.0, 1.0], ..l.clone() };
    for (angle, size, heights) in [
        (0.0, [0.6, 1.2, 0.08], [0.08, 0.02, 0.0, 0.04]),
        (90.0, [1.2, 0.6, 0.08], [0.04, 0.08, 0.02, 0.0]),
        (180.0, [0.6, 1.2, 0.08], [0.0, 0.04, 0.08, 0.02]),
        (270.0, [1.2, 0.6, 0.08], [0.02, 0.0, 0.04, 0.08]),
    ] {
        // The opening is turned even if the distribution has only one plane, which does not change by turning.
        for l in [&l, &alike] {
            let found = by(l, angle).unwrap().luminaire;
            assert_eq!((found.size, found.side_heights), (size, Some(heights)), "{angle}");
            for c in [0.0, 33.0, 90.0, 190.0, 270.0, 300.0] {
                assert!((found.intensity(c + angle, 90.0) - l.intensity(c, 90.0)).abs() < 1e-9, "{angle} {c}");
            }
        }
    }
    // By other angles, only round openings are turned, and luminaires whose opening the simple geometry replaces.
    let error = by(&l, 30.0).unwrap_err();
    let says = "turned by 30 degrees about the axis Z, and its opening of 0.6 x 1.2 x 0.08 m is not round";
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains(says), "{error}");
    for size in [[0.0; 3], [-0.4, -0.4, 0.1]] {
        let l = Luminaire { size, side_heights: None, ..l.clone() };
        let found = by(&l, 30.0).unwrap().luminaire;
        assert_eq!(found.size, size);
        assert!((found.intensity(130.0, 90.0) - 2.0).abs() < 1e-9);
    }
    for angle in [30, 90] {
        let rotation = format!("<X>0</X><Y>0</Y><Z>{angle}</Z><G0>0</G0>");
        let whole = product_of(&write(&l, NOW).unwrap());
        assert_eq!(with_text(&whole, &l, &rotation).unwrap().luminaire.size, l.size);
    }
    let error = turned(&l, "<X>90</X><Y>0</Y><Z>0</Z><G0>0</G0>").unwrap_err();
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains("90 and 0 degrees"), "{error}");
}

#[track_caller]
fn says(bytes: &[u8], what: &str) -> Error {
    let error = read(bytes, None).unwrap_err();
    assert!(error.message.contains(what), "{error}");
    error
}

#[test]
fn wrong_descriptions_are_refused() {
    let good = product("", "");
    let with = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        container(&good.replace(from, to))
    };
    says(&archive(&[("other.xml", b"")]), "product.xml: the container has no such file");
    says(&with("<Root>", "<root>"), "line 1");
    says(&container("<html/>"), "root Root");
    says(&with("emitterId=\"same\"", "emitterId=\"none\""), "Emitters has no Emitter with the id \"none\"");
    says(&with("fixedLightSourceId=\"led\"", "fixedLightSourceId=\"no\""), "FixedLightSource with the id \"no\"");
    says(&with("photometryId=\"pl\"", "x=\"pl\""), "PhotometryReference with photometryId is missing");
    says(&with(">A.ldt<", ">no.ldt<"), "ldc/no.ldt: the container has no such file");
    for name in ["../product.xml", "a/../../b", "/etc/passwd", "C:\\a.ldt", "..\\a.ldt", ""] {
        says(&with(">A.ldt<", &format!(">{name}<")), "leaves the folder");
    }
    let error = says(&with("type=\"localFileName\">A", "type=\"url\">https://a.b/A"), "not in the container");
    assert_eq!(error.kind, ErrorKind::Unsupported);
    says(&with("ldc/eulumdat", "image/png"), "type \"image/png\"; ldc/eulumdat, ldc/ies and ldc/iesxml are read");
    let laser = good.replace("FixedLightEmitter", "LaserLightEmitter");
    let known = "FixedLightEmitter, ChangeableLightEmitter and MultiChannelLightEmitter";
    says(&container(&laser), &format!("LaserLightEmitter is no kind of light emitter; {known} are read"));
    says(&with("<RatedLuminousFlux>1000<", "<RatedLuminousFlux>-1<"), "RatedLuminousFlux is -1");
    says(&container(&good.replace("Variant>", "Other>").replace("<Variant ", "<Other ")), "no variants");
    says(&container("<!DOCTYPE a [<!ENTITY b \"c\">]><Root/>"), "DTD");
    let many = "<EmitterReference emitterId=\"same\"/>".repeat(65);
    let variant = format!("<Variant id=\"many\"><Name/><Geometry>{many}</Geometry></Variant>");
    let error = read(&container(&product("", &variant)), Some("many")).unwrap_err();
    assert!(error.message.contains("65 emitters"), "{error}");
}

/// A file in which many channels or emitters refer to one photometry is refused before the photometry is read for each
/// of them.
#[test]
fn floods_of_photometries_are_refused() {
    let good = product(
        "",
        "<Variant id=\"twice\"><Geometry><ModelGeometryReference><EmitterReference emitterId=\"channels\"/>\
        <EmitterReference emitterId=\"channels\"/></ModelGeometryReference></Geometry></Variant>",
    );
    let start = good.find("<Channel ").unwrap();
    let end = start + good[start..].find("</Channel>").unwrap() + "</Channel>".len();
    let with_channels = |count: usize| good.replacen(&good[start..end], &good[start..end].repeat(count), 1);
    let refused = |count: usize, variant: &str, what: &str| {
        let error = read(&container(&with_channels(count)), Some(variant)).unwrap_err();
        assert!(error.message.contains(what), "{error}");
    };
    refused(64, "Channels", "more than 64 channels");
    refused(100_000, "Channels", "more than 64 channels");
    refused(32, "twice", "the variant refers to more than 64 photometries");
    let most = read(&container(&with_channels(63)), Some("Channels")).unwrap().luminaire;
    assert!((most.flux() / 6500.0 - 1.0).abs() < 1e-3, "{}", most.flux());
    assert_eq!(read(&container(&with_channels(31)), Some("twice")).unwrap().emitters, 2);
    // The photometry file has so many intensities that it may be read once, but not twice.
    let large = Luminaire {
        planes: (0..2048).map(|i| f64::from(i) * 360.0 / 2048.0).collect(),
        gammas: (0..2048).map(|i| f64::from(i) * 180.0 / 2047.0).collect(),
        candela: vec![0.0; 2048 * 2048],
        ..lamp(0.0)
    };
    let ldt = ldt::write(&large).unwrap();
    for (variant, is_read) in [("One", true), ("Channels", false)] {
        let bytes = archive(&[("product.xml", good.as_bytes()), ("ldc/a.ldt", ldt.as_bytes())]);
        match read(&bytes, Some(variant)) {
            Ok(_) => assert!(is_read),
            Err(e) => assert!(!is_read && e.message.contains("8388608 intensities; at most 4194304 are read"), "{e}"),
        }
    }
}

#[test]
fn damaged_and_hostile_archives_are_refused() {
    let good = container(&product("", ""));
    // Every truncated archive gives an error without a panic.
    for end in 0..good.len() {
        assert!(read(&good[..end], None).is_err(), "{end}");
    }
    // A changed byte gives an error or changes nothing.
    let want = read(&good, None).unwrap();
    for at in (0..good.len()).step_by(7) {
        let mut changed = good.clone();
        changed[at] ^= 0x55;
        if let Ok(found) = read(&changed, None) {
            assert_eq!(found, want, "{at}");
        }
    }
    says(b"PK\x05\x06", "damaged");
    // Two files with the same name, apart from upper and lower case.
    let product = product("", "");
    says(&archive(&[("product.xml", product.as_bytes()), ("PRODUCT.XML", b"x")]), "two files with the name");
    // A file that unpacks to more bytes than the limit, and a file whose header states a wrong size.
    let bomb = vec![b' '; super::super::xml::MAX_BYTES + 1];
    says(&archive(&[("product.xml", &bomb)]), "at most");
    let lie = |size: u64, crc: u32| {
        let mut out = Vec::new();
        let mut archive = ZipArchiveWriter::new(&mut out);
        let file = archive.new_file("product.xml").compression_method(CompressionMethod::DEFLATE);
        let (mut entry, _) = file.start().unwrap();
        entry.write_all(&compress_to_vec(b"<Root/>", 6)).unwrap();
        entry.finish(DataDescriptorOutput::new(crc, size)).unwrap();
        archive.finish().unwrap();
        out
    };
    says(&lie(7, rawzip::crc32(b"<Root/>")), "root Root");
    says(&lie(7, 1), "checksum");
    says(&lie(6, rawzip::crc32(b"<Root/>")), "unpack to 6 bytes");
    says(&lie(1 << 24, rawzip::crc32(b"<Root/>")), "unpack to 16777216 bytes");
    says(&lie(u64::MAX / 2, 1), "at most");
    let files: Vec<(String, &[u8])> = (0..4100).map(|i| (format!("{i}"), &b""[..])).collect();
    let list: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (name.as_str(), *bytes)).collect();
    says(&archive(&list), "4100 files");
}
