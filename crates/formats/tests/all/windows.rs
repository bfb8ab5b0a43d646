//! A picture is what its display window shows, whatever of it has pixels; and what is no light is told.

use straal_formats::Limits;
use straal_formats::image::{self, Photo, exr};

/// A picture of 6 x 4 whose pixels from `x`, `y` on are told, 3 x 2 of them.
fn part(x: i32, y: i32, pixels: [f32; 6]) -> Vec<u8> {
    let mut picture = exr::Layered::of_size(6, 4);
    picture.data_window = exr::Window { x, y, width: 3, height: 2 };
    picture.layers = vec![exr::Layer::from_rgb("", &pixels.map(|v| [v; 3]))];
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).unwrap();
    bytes
}

#[test]
fn what_has_no_pixels_is_black_and_what_lies_beyond_is_cut() {
    let whole = |x: i32, y: i32| {
        let bytes = part(x, y, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let header = image::header(&bytes, &Limits::default()).unwrap();
        assert_eq!((header.width, header.height), (6, 4));
        let (picture, notes) = image::surroundings(&bytes, &Limits::default()).unwrap();
        assert_eq!((picture.width, picture.height, notes.len()), (6, 4, 1));
        assert_eq!(picture, image::read(&bytes, &Limits::default()).unwrap());
        picture.pixels.iter().map(|p| p[0] as u8).collect::<Vec<_>>()
    };
    let row = |at: usize, row: [u8; 6]| [vec![0; 6 * at], row.to_vec()].concat();
    let inside = [row(1, [0, 0, 1, 2, 3, 0]), vec![0, 0, 4, 5, 6, 0], vec![0; 6]].concat();
    assert_eq!(whole(2, 1), inside);
    assert_eq!(whole(-2, -1), [vec![6, 0, 0, 0, 0, 0], vec![0; 18]].concat());
    assert_eq!(whole(5, 3), row(3, [0, 0, 0, 0, 0, 1]));
    assert_eq!(whole(-9, 1), [0; 24]);
}

#[test]
fn a_frame_may_begin_anywhere() {
    let mut picture = exr::Layered::of_size(2, 1);
    picture.display_window = exr::Window { x: -7, y: 100, width: 2, height: 1 };
    picture.data_window = exr::Window { x: -8, y: 99, width: 2, height: 2 };
    picture.layers = vec![exr::Layer::from_rgb("", &[[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]])];
    assert_eq!(picture.to_image().unwrap().pixels, [[4.0; 3], [0.0; 3]]);
}

#[test]
fn a_crop_of_straal_is_known() {
    let mut picture = exr::Layered::of_size(6, 4);
    picture.data_window = exr::Window { x: 2, y: 1, width: 3, height: 2 };
    picture.layers = vec![exr::Layer::from_rgb("", &[[1.0; 3]; 6])];
    let is_crop = |picture: &exr::Layered| Photo::of_exr(picture, None).unwrap().is_crop();
    assert!(!is_crop(&picture));
    picture.metadata = vec![("straal.crop".into(), "2,1,5,3".into())];
    assert!(is_crop(&picture));
    picture.data_window.x = 1;
    assert!(!is_crop(&picture));
}

#[test]
fn light_that_is_none_is_told_with_its_place() {
    let bytes = part(2, 1, [1.0, f32::INFINITY, 3.0, f32::INFINITY, f32::NAN, -6.0]);
    let (picture, notes) = image::surroundings(&bytes, &Limits::default()).unwrap();
    let told = notes.join("\n");
    for want in [
        "numbers of 2 pixels are infinite, the first at 3, 1: 65504 is taken",
        "a number of the pixel 3, 2 is no number (NaN): 0 is taken",
        "a number of the pixel 4, 2 is below 0",
        "it has 3 x 2 pixels from 2, 1 of a picture of 6 x 4",
    ] {
        assert!(told.contains(want), "{told}");
    }
    assert_eq!(picture.pixels[6 + 3], [65504.0; 3]);
    assert!(picture.pixels.iter().flatten().all(|v| v.is_finite()));
}

/// Of a file without colours in its root the picture is read, and not what comes first.
#[test]
fn surroundings_are_the_picture_of_a_file_with_layers() {
    let read = |names: &[&str]| {
        let mut picture = exr::Layered::of_size(2, 1);
        picture.layers =
            names.iter().map(|name| exr::Layer::from_rgb(name, &[[name.len() as f32; 3]; 2])).collect();
        let mut bytes = Vec::new();
        exr::write(&mut bytes, &picture).unwrap();
        let (image, notes) = image::surroundings(&bytes, &Limits::default()).unwrap();
        (image.pixels[0][0], notes.join(", "))
    };
    assert_eq!(read(&["ViewLayer.AO", "ViewLayer.Combined"]), (18.0, String::new()));
    assert_eq!(read(&["albedo", "zcolor.BEAUTY"]), (13.0, String::new()));
    let (first, told) = read(&["left", "a.right"]);
    assert_eq!((first, told.contains("`a.right` and `left`: `a.right` is taken")), (7.0, true), "{told}");
}

/// Files with a part for each layer are read by the same meaning.
#[test]
fn surroundings_are_the_picture_of_a_file_with_parts() {
    use ::exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, Vec2, WritableImage,
    };
    let read = |names: &[&str]| {
        let part = |(i, name): (usize, &&str)| {
            let value = |channel: &str| AnyChannel::new(channel, FlatSamples::F32(vec![i as f32 + 1.0; 2]));
            let channels =
                if name.contains("Depth") { vec![value("Z")] } else { ["R", "G", "B"].map(value).into() };
            let channels = AnyChannels::sort(channels.into_iter().collect());
            Layer::new(Vec2(2, 1), LayerAttributes::named(*name), Encoding::UNCOMPRESSED, channels)
        };
        let layers: Vec<_> = names.iter().enumerate().map(part).collect();
        let window = ::exr::prelude::IntegerBounds::new((0, 0), (2, 1));
        let image = Image::from_layers(::exr::prelude::ImageAttributes::new(window), layers);
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).unwrap();
        let photo = Photo::read(bytes.get_ref(), &Limits::default()).unwrap();
        (photo.pixels[0][0] as u8, photo.notes.len())
    };
    assert_eq!(read(&["ViewLayer.Depth", "ViewLayer.AO", "ViewLayer.Combined"]), (3, 0));
    assert_eq!(read(&["albedo", "RGBA", "normal"]), (2, 0));
    assert_eq!(read(&["key", "fill", "Depth"]), (1, 1));
}

/// A few thousand bytes can't make the machine allocate gigabytes, whatever the format.
#[test]
fn a_promise_beyond_the_limits_is_refused_before_it_is_kept() {
    let mut picture = exr::Layered::of_size(1, 1);
    picture.layers = vec![exr::Layer::from_rgb("", &[[1.0; 3]])];
    picture.display_window = exr::Window::of_size(16_384, 16_384);
    let mut bytes = Vec::new();
    exr::write(&mut bytes, &picture).unwrap();
    let limits = Limits { max_decoded: 1 << 20, ..Limits::default() };
    let refused = image::surroundings(&bytes, &limits).unwrap_err().to_string();
    assert!(refused.starts_with("the picture is too large: it would take 3.22 GB"), "{refused}");
    assert!(image::header(&bytes, &limits).is_err());
    let told = image::header(&bytes, &Limits::default()).unwrap();
    assert!(told.decoded_bytes >= 12 << 28 && told.kept_bytes() == 12 << 28);
}
