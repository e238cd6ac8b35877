//! Tests that reading a file stays within the context's memory budget, decoders included, and works on small stacks.
//!
//! The tests measure the peak memory of the process, so they have a program of their own and run one at a time.

mod host;

use host::message;
use image::codecs::{bmp::BmpEncoder, gif::GifEncoder, jpeg::JpegEncoder, png::PngEncoder, webp::WebPEncoder};
use image::{ExtendedColorType, Frame, ImageEncoder, RgbImage, RgbaImage};
use luxfer::ffi::*;
use miniz_oxide::deflate::compress_to_vec_zlib;
use std::ptr::null_mut;
use std::sync::{Mutex, MutexGuard};

/// Locks a mutex for the duration of a test, so that the tests of this file run one at a time.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}

/// Bytes by which the rest of the process may grow while a file is read: pages of the program and of its allocator.
const NOISE: u64 = 3 << 20;

/// Reads the memory figure `name` (such as `VmRSS:`) of this process, in bytes; `None` if the system does not report
/// it.
fn figure(name: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<u64>().ok()? * 1024)
}

/// Returns the result of `work`, and by how many bytes the process grew at its peak, if the system reports it.
fn growth<T>(work: impl FnOnce() -> T) -> (T, Option<u64>) {
    // Return freed memory to the system first.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    unsafe {
        libc::malloc_trim(0);
    }
    let is_reset = std::fs::write("/proc/self/clear_refs", "5").is_ok();
    let before = figure("VmRSS:");
    let value = work();
    (value, figure("VmHWM:").zip(before).filter(|_| is_reset).map(|(peak, before)| peak.saturating_sub(before)))
}

fn with_budget(mib: u64) -> *mut luxfer_context {
    let params = luxfer_context_params { struct_size: 16, num_threads: 1, memory_budget_mib: mib };
    host::made(|out| unsafe { luxfer_context_create(&params, out) })
}

/// Loads a picture from memory in a context with a budget of `mib` MiB (0 = none), and releases it. Returns the
/// status, the message and the growth of the process in bytes.
fn load(file: &[u8], mib: u64) -> (luxfer_status, String, Option<u64>) {
    let context = with_budget(mib);
    let mut image = null_mut();
    let (status, grown) = growth(|| unsafe {
        luxfer_image_load_memory(context, file.as_ptr().cast(), file.len(), LUXFER_COLOUR_SRGB, &mut image)
    });
    let message = message(context);
    unsafe {
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
    }
    (status, message, grown)
}

/// A PNG of 2 x 2 pixels with one additional chunk before its pixels.
fn png_with(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut png = Vec::new();
    PngEncoder::new(&mut png).write_image(&[128; 12], 2, 2, ExtendedColorType::Rgb8).unwrap();
    let checksum = crc32(&[name, content].concat());
    let chunk = [&(content.len() as u32).to_be_bytes(), &name[..], content, &checksum.to_be_bytes()].concat();
    png.splice(33..33, chunk);
    png
}

/// The checksum of PNG chunks (PNG specification, third edition, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 })
    })
}

/// Returns `len` zero bytes, compressed by deflate to about a thousandth of their size.
fn bomb(len: usize) -> Vec<u8> {
    compress_to_vec_zlib(&vec![0; len], 6)
}

#[test]
fn packed_chunks_of_a_png_stay_within_the_budget() {
    let _alone = alone();
    let packed = bomb(544 << 20);
    let profile = [b"name\0\0", &packed[..]].concat();
    let text = [b"Title\0\0", &packed[..]].concat();
    let international = [b"Title\0\x01\0\0\0", &packed[..]].concat();
    for (name, content) in [(b"iCCP", &profile), (b"zTXt", &text), (b"iTXt", &international), (b"tEXt", &text)] {
        let file = png_with(name, content);
        for mib in [1, 16] {
            let (status, message, grown) = load(&file, mib);
            let called = String::from_utf8_lossy(name);
            assert!(grown.is_none_or(|grown| grown <= (mib << 20) + NOISE), "{called} of {mib} MiB grew {grown:?}");
            // A reader may skip text chunks without unpacking them, so the file may load.
            match (name, status) {
                (_, LUXFER_OUT_OF_MEMORY) => assert!(message.contains("budget"), "{message}"),
                (_, status) => assert_eq!(status, LUXFER_OK, "{called} of {mib} MiB: {message}"),
            }
        }
        assert_eq!(load(&file, 0).0, LUXFER_OK, "without a budget");
    }
    // A small chunk that unpacks to 3 MiB exceeds a budget of 1 MiB.
    let small = [b"name\0\0", &bomb(3 << 20)[..]].concat();
    assert_eq!(load(&png_with(b"iCCP", &small), 1).0, LUXFER_OUT_OF_MEMORY);
}

/// Files of pictures with 800 × 700 pixels (6.4 MiB as floating-point numbers), in each format that this test can
/// write.
fn pictures() -> Vec<(&'static str, Vec<u8>)> {
    const SIZE: [u32; 2] = [800, 700];
    let noise = |x: u32, y: u32, c: u32| (x.wrapping_mul(31) ^ y.wrapping_mul(57).wrapping_add(c * 91)) as u8;
    let [width, height] = SIZE;
    let rgb = RgbImage::from_fn(width, height, |x, y| image::Rgb([0, 1, 2].map(|c| noise(x, y, c))));
    let rgba = RgbaImage::from_fn(width, height, |x, y| image::Rgba([0, 1, 2, 3].map(|c| noise(x, y, c))));
    let colour = ExtendedColorType::Rgb8;
    let file = |write: &dyn Fn(&mut Vec<u8>)| {
        let mut file = Vec::new();
        write(&mut file);
        file
    };
    let exr = {
        let context = host::context(1);
        let mut pixels: Vec<f32> = rgb.iter().map(|&v| f32::from(v) / 255.0).collect();
        let view = host::view(width, height, &mut pixels);
        let image = host::made(|out| unsafe { luxfer_image_create(context, &view, out) });
        let path = std::env::temp_dir().join(format!("luxfer-decoders-{}.exr", std::process::id()));
        let name = std::ffi::CString::new(path.to_str().unwrap()).unwrap();
        unsafe {
            assert_eq!(luxfer_image_save(image, name.as_ptr(), 1.0), LUXFER_OK);
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
        }
        let file = std::fs::read(&path).unwrap();
        std::fs::remove_file(path).unwrap();
        file
    };
    let radiance = {
        let mut file = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
        file.extend(rgb.pixels().flat_map(|p| [p[0] | 128, p[1], p[2], 128]));
        file
    };
    vec![
        ("png", file(&|f| PngEncoder::new(f).write_image(&rgb, width, height, colour).unwrap())),
        ("jpeg", file(&|f| JpegEncoder::new_with_quality(f, 90).encode(&rgb, width, height, colour).unwrap())),
        ("webp", file(&|f| WebPEncoder::new_lossless(f).encode(&rgb, width, height, colour).unwrap())),
        ("bmp", file(&|f| BmpEncoder::new(f).encode(&rgb, width, height, colour).unwrap())),
        ("gif", file(&|f| GifEncoder::new(f).encode_frame(Frame::new(rgba.clone())).unwrap())),
        ("tiff", tiff(SIZE, 3, rgb.as_raw(), None)),
        ("tiff of inks", tiff(SIZE, 4, rgba.as_raw(), Some(&ink_profile()))),
        ("exr", exr),
        ("hdr", radiance),
    ]
}

/// An uncompressed TIFF with one strip: RGB for 3 `samples`, CMYK for 4; with or without an ICC profile.
fn tiff([width, height]: [u32; 2], samples: u32, pixels: &[u8], profile: Option<&[u8]>) -> Vec<u8> {
    let tags = 9 + u32::from(profile.is_some());
    let (bits, len) = (8 + 2 + tags * 12 + 4, samples * width * height);
    let strip = bits + 2 * samples;
    let photometric = if samples == 4 { 5 } else { 2 };
    // Width, height, bits, no compression, colours, offset, samples, rows, length, profile.
    let mut entries: Vec<(u16, u16, u32, u32)> = vec![
        (256, 4, 1, width),
        (257, 4, 1, height),
        (258, 3, samples, bits),
        (259, 3, 1, 1),
        (262, 3, 1, photometric),
        (273, 4, 1, strip),
        (277, 3, 1, samples),
        (278, 4, 1, height),
        (279, 4, 1, len),
    ];
    entries.extend(profile.map(|profile| (34_675, 7, profile.len() as u32, strip + len)));
    let mut file = [b"II*\0\x08\0\0\0", &(tags as u16).to_le_bytes()[..]].concat();
    for (tag, kind, count, value) in entries {
        file.extend([tag.to_le_bytes(), kind.to_le_bytes()].concat());
        file.extend([count.to_le_bytes(), value.to_le_bytes()].concat());
    }
    file.extend([0; 4]);
    file.extend([8, 0].repeat(samples as usize));
    file.extend(pixels);
    file.extend(profile.unwrap_or_default());
    file
}

/// An ICC profile that converts CMYK by a table with two grid points per ink (ICC.1:2022, section 10.11, `lut8Type`).
fn ink_profile() -> Vec<u8> {
    let ramp: Vec<u8> = (0..=255).collect();
    let mut table = b"mft1\0\0\0\0\x04\x03\x02\0".to_vec();
    for entry in 0..9 {
        table.extend(if entry % 4 == 0 { [0, 1, 0, 0] } else { [0; 4] });
    }
    table.extend(ramp.repeat(4));
    table.extend((0..16u8).flat_map(|inks| [255 - 17 * inks, 128, 128]));
    table.extend(ramp.repeat(3));
    let mut profile = vec![0; 128];
    profile[8] = 2;
    profile[12..24].copy_from_slice(b"prtrCMYKLab ");
    profile[36..40].copy_from_slice(b"acsp");
    for word in [1u32.to_be_bytes(), *b"A2B0", 144u32.to_be_bytes(), (table.len() as u32).to_be_bytes()] {
        profile.extend(word);
    }
    profile.extend(table);
    let size = profile.len() as u32;
    profile[..4].copy_from_slice(&size.to_be_bytes());
    profile
}

#[test]
fn the_profile_of_the_inks_is_used() {
    let picture = |profile: Option<&[u8]>| {
        let file = tiff([1, 1], 4, &[0, 0, 0, 255], profile);
        let context = host::context(1);
        let image = host::made(|out| unsafe {
            luxfer_image_load_memory(context, file.as_ptr().cast(), file.len(), LUXFER_COLOUR_SRGB, out)
        });
        let mut pixel = [0.0; 3];
        let view = host::view(1, 1, &mut pixel);
        unsafe {
            assert_eq!(luxfer_image_read(image, 0, &view), LUXFER_OK);
            assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
            assert_eq!(luxfer_release(context.cast()), LUXFER_OK);
        }
        pixel
    };
    assert!(picture(None).iter().all(|&v| v < 0.01), "black ink without a profile");
    // The last ink varies fastest, so entry 1 of the table is black ink alone: lightness 100 (1 - 17/255).
    let [red, green, blue] = picture(Some(&ink_profile()));
    let luminance = ((93.333f32 + 16.0) / 116.0).powi(3);
    assert!((green - luminance).abs() < 0.01 && (red - blue).abs() < 0.01, "{red} {green} {blue}");
}

#[test]
fn every_decoder_stays_within_the_budget() {
    let _alone = alone();
    for (name, file) in pictures() {
        let (mut smallest, mut refused) = (None, 0);
        for mib in [4, 7, 8, 9, 10, 12, 14, 16, 24, 32, 48, 1024] {
            let (status, message, grown) = load(&file, mib);
            assert!(grown.is_none_or(|grown| grown <= (mib << 20) + NOISE), "{name} under {mib} MiB grew {grown:?}");
            match status {
                LUXFER_OK => smallest = smallest.or(Some(mib)),
                LUXFER_OUT_OF_MEMORY => refused = mib,
                _ => panic!("{name} under {mib} MiB: {message}"),
            }
        }
        println!("{name}: read from {smallest:?} MiB on");
        let smallest = smallest.unwrap_or_else(|| panic!("{name} cannot be read"));
        assert!(refused < smallest, "{name}: refused under {refused} MiB, read under {smallest}");
    }
}

/// Minimum stack of a host's thread, as the guide states it.
const MIN_STACK: usize = 128 << 10;

/// A glTF file with custom data (extras), nested as deeply as the JSON reader allows.
fn nested_gltf() -> Vec<u8> {
    let extras = format!("{{\"data\":{}1{}}}", "[".repeat(120), "]".repeat(120));
    format!(r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"name":"a","extras":{extras}}}],"scenes":[{{"nodes":[0]}}]}}"#)
        .into()
}

/// Loads a scene from memory and releases it; returns the status of the load.
fn load_scene(context: *mut luxfer_context, file: &[u8]) -> luxfer_status {
    let mut scene = null_mut();
    unsafe {
        let status = luxfer_scene_load_memory(
            context,
            file.as_ptr().cast(),
            file.len(),
            std::ptr::null(),
            std::ptr::null(),
            &mut scene,
        );
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        status
    }
}

/// Writing function of the caller: appends the data to the `Vec<u8>` at `file`.
unsafe extern "C" fn collect(file: *mut std::ffi::c_void, data: *const std::ffi::c_void, size: usize) -> i32 {
    let file = unsafe { &mut *file.cast::<Vec<u8>>() };
    file.extend_from_slice(unsafe { std::slice::from_raw_parts(data.cast(), size) });
    0
}

/// Calls functions that finish their work before they return (instead of starting a job).
fn quick_calls(context: *mut luxfer_context) {
    let (image, scene) = (host::image(context, 320, 240, 0.5), host::scene(context));
    let same = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let ray = luxfer_ray { origin: [1.0, 0.0, 1.0], direction: [0.0, 1.0, 0.0], t_max: f32::INFINITY };
    let mut hits = vec![luxfer_hit { t: 0.0, mesh: 0, triangle: 0, u: 0.0, v: 0.0 }; 10_000];
    let mut needs = unsafe { std::mem::zeroed::<luxfer_requirements>() };
    let mut sheet = unsafe { std::mem::zeroed::<luxfer_sheet_params>() };
    let mut file = Vec::<u8>::new();
    unsafe {
        assert_eq!(
            luxfer_scene_intersect(scene, vec![ray; 10_000].as_ptr(), 10_000, 0, hits.as_mut_ptr(), 0),
            LUXFER_OK
        );
        assert_eq!(luxfer_scene_get_requirements(scene, 0.1, &mut needs, size_of_val(&needs)), LUXFER_OK);
        let made = |make: &dyn Fn(*mut *mut luxfer_image) -> luxfer_status| {
            assert_eq!(luxfer_release(host::made(make).cast()), LUXFER_OK);
        };
        made(&|out| luxfer_image_warp(image, same.as_ptr(), 300, 200, out));
        made(&|out| luxfer_image_false_colour(image, std::ptr::null(), out));
        assert_eq!(luxfer_init(LUXFER_STRUCT_SHEET_PARAMS, (&raw mut sheet).cast(), size_of_val(&sheet)), LUXFER_OK);
        let sheet = luxfer_sheet_params { paper_width: 100.0, paper_height: 80.0, dpi: 50.0, ..sheet };
        let printed = host::made(|out| luxfer_sheet_print(image, &sheet, out));
        made(&|out| luxfer_sheet_align(printed, 32, 24, &sheet, out, null_mut(), 0));
        assert_eq!(luxfer_release(printed.cast()), LUXFER_OK);
        assert_eq!(luxfer_scene_export_memory(scene, Some(collect), (&raw mut file).cast()), LUXFER_OK);
        assert_eq!(load_scene(context, &file), LUXFER_OK);
        assert_eq!(luxfer_release(scene.cast()), LUXFER_OK);
        assert_eq!(luxfer_release(image.cast()), LUXFER_OK);
    }
}

#[test]
fn a_thread_with_a_small_stack_can_read_files_and_make_quick_calls() {
    let _alone = alone();
    let mut files = pictures();
    let profile = [b"name\0\0", &compress_to_vec_zlib(&[0; 4000], 6)[..]].concat();
    files.push(("png with a profile", png_with(b"iCCP", &profile)));
    let work = move || {
        let context = with_budget(0);
        for (name, file) in &files {
            assert_eq!(load(file, 0).0, LUXFER_OK, "{name}");
        }
        assert_eq!(load_scene(context, &nested_gltf()), LUXFER_OK, "{}", message(context));
        quick_calls(context);
        assert_eq!(unsafe { luxfer_release(context.cast()) }, LUXFER_OK);
    };
    std::thread::Builder::new().stack_size(MIN_STACK).spawn(work).unwrap().join().unwrap();
}
