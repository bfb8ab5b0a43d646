//! The single definition from which come a description type, its reading, its writing, its defaults and its schema.

/// Defines a struct or an enum of the scene language.
///
/// A struct is a mapping: `key: Type [limit] = default,` where the limit on its numbers and the default may be
/// absent; a key without default must be given. `pub struct Name [check] {` names a function that looks at the
/// whole. After the body, `with field: Type` takes the keys of another struct into the same mapping.
///
/// An enum is externally tagged: `"key" => Variant(Payload),` is read from `key: payload`, and the bare `key` does
/// when there is no payload or all of its keys have defaults.
macro_rules! describe {
    (
        $(#[doc = $doc:literal])+
        pub struct $T:ident $([$check:path])? {
            $( $(#[doc = $fdoc:literal])+ $f:ident : $ty:ty $([$limit:expr])? $(= $default:expr)?, )*
        }
        $(with $flat:ident : $Flat:ty)?
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $T {
            $( $(#[doc = $fdoc])+ pub $f: $ty, )*
            $( /// What all surfaces share; its keys are written beside the others.
            pub $flat: $Flat, )?
        }
        describe!(@default $T { $( $f $(= $default)?, )* } { $( $flat: $Flat )? });
    };

    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident {
            $( $(#[doc = $vdoc:literal])+ $key:literal => $V:ident $(($P:ty))?, )+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub enum $T {
            $( $(#[doc = $vdoc])+ $V $(($P))?, )+
        }
    };

    // A struct whose every key has a default has one itself.
    (@default $T:ident { $( $f:ident = $default:expr, )* } { $( $flat:ident : $Flat:ty )? }) => {
        impl Default for $T {
            fn default() -> Self {
                Self { $( $f: $default, )* $( $flat: <$Flat>::default(), )? }
            }
        }
    };
    (@default $($other:tt)*) => {};
}
pub(crate) use describe;
