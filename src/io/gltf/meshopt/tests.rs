use super::codec::{decode_attributes, decode_sequence, decode_triangles};
use super::filter::undo_filter;

// Made with the encoder of meshoptimizer 1.1.

/// 40 elements of 8 bytes: steady, curved, repeating and broken columns, and what they decode to.
const ATTRIBUTES: [&str; 2] = [
    "a02a066666666666666666666666666666666666666600000000001f000105090d1115191d2125292d3135393d4145494d51\
    55595d6165696d717579ffff00007d8185898d9195991440010040404100002a0eeeefeeeefeeeef373737eeeefeeeefeeee\
    fe373737eeefeeee000000003700140035555533555500000400100000000000000000000000000000000000000000000000\
    0000000000e80300000500",
    "0000e803000005000300e703070005000600e4030e0005000900df03150005000c00d8031c0005000f00cf03000005001200\
    c403070005001500b7030e0005001800a803150005001b0097031c0005001e0084030000050021006f030700050024005803\
    0e00050027003f03150005002a0024031c0005002d000703000005003000e802070005003300c7020e0005003600a4021500\
    050039007f021c0005003c005802000005003f002f020700ebff420004020e00eaff4500d7011500e9ff4800a8011c00e8ff\
    4b0077010000e7ff4e0044010700e6ff51000f010e00e5ff5400d8001500e4ff57009f001c00e3ff5a0064000000e2ff5d00\
    27000700e1ff6000e8ff0e00e0ff6300a7ff1500dfff660064ff1c00deff69001fff0000ddff6c00d8fe0700dcff6f008ffe\
    0e00dbff720044fe1500daff7500f7fd1c00d9ff",
];
/// A grid of 5 x 5 squares, two triangles with far corners, and what they decode to.
const TRIANGLES: &str = "e1fe001e001e001e001e00fe0c1e0b1e0a1e091e08ff071e071e071e071e07ff071e071e071e071e07ff071e071e071e071e\
    07ffffff0c02ff0202ff090c02ff090c02ff090c021f45228f1b0c007687566778a9866589689801690000";
const TRIANGLE_INDICES: [u32; 156] = [
    0, 6, 7, 0, 7, 1, 1, 7, 8, 1, 8, 2, 2, 8, 9, 2, 9, 3, 3, 9, 10, 3, 10, 4, 4, 10, 11, 4, 11, 5, 6, 12, 13,
    6, 13, 7, 7, 13, 14, 7, 14, 8, 8, 14, 15, 8, 15, 9, 9, 15, 16, 9, 16, 10, 10, 16, 17, 10, 17, 11, 12, 18,
    19, 12, 19, 13, 13, 19, 20, 13, 20, 14, 14, 20, 21, 14, 21, 15, 15, 21, 22, 15, 22, 16, 16, 22, 23, 16,
    23, 17, 18, 24, 25, 18, 25, 19, 19, 25, 26, 19, 26, 20, 20, 26, 27, 20, 27, 21, 21, 27, 28, 21, 28, 22,
    22, 28, 29, 22, 29, 23, 24, 30, 31, 24, 31, 25, 25, 31, 32, 25, 32, 26, 26, 32, 33, 26, 33, 27, 27, 33,
    34, 27, 34, 28, 28, 34, 35, 28, 35, 29, 0, 35, 17, 3, 30, 9,
];
const SEQUENCE: &str = "d1000404000218b10905a48b119f09010300000000";
/// Filtered elements, and what they stand for.
const FILTERED: [(&str, usize, &str, &str); 4] = [
    ("OCTAHEDRAL", 4, "00007f0036b77f00ad5c7f005a5a7f00", "00007f004c9a0000c44cae003f3fa600"),
    (
        "OCTAHEDRAL",
        8,
        "00000000ff7f0000db36dcb6ff7f0000a7ac475cff7f0000825a825aff7f0000",
        "00000000ff7f0000cc4c9a990000000090c2cc4c14ae0000ff3fff3f7ea50000",
    ),
    (
        "QUATERNION",
        8,
        "000000000000ff7f825a825a825afc7fb2c9188ce6edfd7f000064930000ff7f",
        "000000000000ff7fff3f00400040004033f399599ad90bae000034b300006566",
    ),
    (
        "EXPONENTIAL",
        12,
        "0000000600000006093d0006003400f4000000f4000000f4",
        "000000000000000000247449000050400000000000000000",
    ),
];

fn bytes(hex: &str) -> Vec<u8> {
    (0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()).collect()
}

#[test]
fn attributes_decode_to_what_was_encoded() {
    let [packed, plain] = ATTRIBUTES.map(bytes);
    assert_eq!(decode_attributes(&packed, 40, 8), Some(plain));
}

#[test]
fn indices_decode_to_what_was_encoded() {
    assert_eq!(decode_triangles(&bytes(TRIANGLES), TRIANGLE_INDICES.len()).unwrap(), TRIANGLE_INDICES);
    let sequence = [0, 1, 2, 2, 1, 7, 300, 301, 70_000, 5, 5, 4];
    assert_eq!(decode_sequence(&bytes(SEQUENCE), sequence.len()).unwrap(), sequence);
}

#[test]
fn filters_are_undone() {
    for (name, stride, filtered, plain) in FILTERED {
        let mut data = bytes(filtered);
        undo_filter(name, stride, &mut data).unwrap();
        assert_eq!(data, bytes(plain), "{name} {stride}");
    }
    assert_eq!(undo_filter("COLOR", 4, &mut []), None);
}

/// Whatever is cut off or changed: no panic, and never more than was asked for.
#[test]
fn damaged_data_are_refused_or_harmless() {
    let packed = [bytes(ATTRIBUTES[0]), bytes(TRIANGLES), bytes(SEQUENCE)];
    let decode = |data: &[u8]| {
        (
            decode_attributes(data, 40, 8),
            decode_triangles(data, TRIANGLE_INDICES.len()),
            decode_sequence(data, 12),
        )
    };
    for data in &packed {
        for length in 0..data.len() {
            decode(&data[..length]);
        }
        for at in 0..data.len() {
            for bit in 0..8 {
                let mut damaged = data.clone();
                damaged[at] ^= 1 << bit;
                decode(&damaged);
            }
        }
    }
    let [attributes, triangles, sequence] = &packed;
    assert_eq!(decode_attributes(&attributes[..60], 40, 8), None);
    assert_eq!(decode_triangles(&triangles[..40], TRIANGLE_INDICES.len()), None);
    assert_eq!(decode_sequence(&sequence[..10], 12), None);
}
