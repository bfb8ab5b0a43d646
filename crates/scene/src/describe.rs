//! The single definition from which come a description type, its reading, its writing, its defaults, its schema and a way to look
//! through its values.

/// Defines a struct or an enum of the scene language.
///
/// A struct is a mapping: `key: Type [limit] = default,` where the limit on its numbers and the default may be
/// absent; a key without default must be given. `pub struct Name [check] {` names a function that looks at the
/// whole. After the body, `with field: Type` takes the keys of another struct into the same mapping.
///
/// An enum is externally tagged: `"key" => Variant(Payload),` is read from `key: payload`, and the bare `key` does
/// when there is no payload or all of its keys have defaults. `"key" => Variant(struct Payload { .. }),` defines the payload, under
/// the same description, in place. `pub enum Name each with field: Type {` gives each of these the keys of another struct, and the enum a function that
/// asks for it; `each has field: Type` the function alone.
macro_rules! describe {
    (
        $(#[doc = $doc:literal])+
        pub struct $T:ident $([$check:path])? {
            $( $(#[doc = $fdoc:literal])+ $f:ident : $ty:ty $([$limit:expr])? $(= $default:expr)?, )*
        }
        $(with $flat:ident : $Flat:ty)*
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        pub struct $T {
            $( $(#[doc = $fdoc])+ pub $f: $ty, )*
            $( /// What several kinds share; its keys are written beside the others.
            pub $flat: $Flat, )*
        }

        describe!(@default $T { $( $f $(= $default)?, )* } { $( $flat: $Flat )* });

        impl $crate::decode::Fields for $T {
            fn names(out: &mut Vec<&'static str>) {
                out.extend([$( stringify!($f) ),*]);
                $( <$Flat as $crate::decode::Fields>::names(out); )*
            }

            fn read_fields(keys: &mut $crate::decode::Keys<'_>, d: &mut $crate::decode::Decoder) -> Self {
                Self {
                    $( $f: keys.field(
                        stringify!($f),
                        describe!(@limit $($limit)?),
                        describe!(@absent $ty $(, $default)?),
                        d,
                    ), )*
                    $( $flat: <$Flat as $crate::decode::Fields>::read_fields(keys, d), )*
                }
            }

            fn blank_fields() -> Self {
                Self {
                    $( $f: describe!(@blank $ty $(, $default)?), )*
                    $( $flat: <$Flat as $crate::decode::Fields>::blank_fields(), )*
                }
            }

            fn write_fields(&self, out: &mut dyn $crate::writer::Writer) {
                $(
                    if describe!(@differs self $f $ty $(, $default)?) {
                        $crate::decode::write_entry(stringify!($f), &self.$f, out);
                    }
                )*
                $( <$Flat as $crate::decode::Fields>::write_fields(&self.$flat, out); )*
                let _ = out;
            }

            fn schema_fields(out: &mut $crate::schema::Properties, defs: &mut $crate::schema::Definitions) {
                $(
                    let absent: Option<fn() -> $ty> = describe!(@absent $ty $(, $default)?);
                    out.add(
                        stringify!($f),
                        &[$($fdoc),+],
                        <$ty as $crate::decode::Describe>::schema(describe!(@limit $($limit)?), defs),
                        absent.map(|default| $crate::decode::Describe::write(&default())),
                    );
                )*
                $( <$Flat as $crate::decode::Fields>::schema_fields(out, defs); )*
            }

            fn all_optional() -> bool {
                $( describe!(@optional $($default)?) && )*
                $( <$Flat as $crate::decode::Fields>::all_optional() && )* true
            }

            fn show_fields<'a>(&'a self, visitor: &mut dyn $crate::visit::Visitor<'a>) {
                $( $crate::decode::Describe::show(&self.$f, describe!(@limit $($limit)?), visitor); )*
                $( <$Flat as $crate::decode::Fields>::show_fields(&self.$flat, visitor); )*
                let _ = visitor;
            }

            fn lead_fields(&mut self, places: &$crate::link::Places) {
                $( $crate::decode::Describe::lead(&mut self.$f, places); )*
                $( <$Flat as $crate::decode::Fields>::lead_fields(&mut self.$flat, places); )*
                let _ = places;
            }
        }

        impl $crate::decode::Describe for $T {
            fn read(
                tree: &$crate::tree::Tree,
                _: $crate::limit::Limit,
                d: &mut $crate::decode::Decoder,
            ) -> Self {
                d.fields(tree, describe!(@check $($check)?))
            }

            fn blank() -> Self {
                <Self as $crate::decode::Fields>::blank_fields()
            }

            fn write_to(&self, out: &mut dyn $crate::writer::Writer) {
                out.begin_map();
                $crate::decode::Fields::write_fields(self, out);
                out.end_map();
            }

            fn schema(
                _: $crate::limit::Limit,
                defs: &mut $crate::schema::Definitions,
            ) -> ::serde_json::Value {
                defs.refer(stringify!($T), |defs| {
                    let mut properties = $crate::schema::Properties::default();
                    <Self as $crate::decode::Fields>::schema_fields(&mut properties, defs);
                    properties.into_schema(&[$($doc),+])
                })
            }

            fn may_be_empty() -> bool {
                <Self as $crate::decode::Fields>::all_optional()
            }

            fn show<'a>(
                &'a self,
                _: $crate::limit::Limit,
                visitor: &mut dyn $crate::visit::Visitor<'a>,
            ) {
                $crate::decode::Fields::show_fields(self, visitor);
            }

            fn lead(&mut self, places: &$crate::link::Places) {
                $crate::decode::Fields::lead_fields(self, places);
            }
        }
    };

    // An enum of which each kind is defined in place: one entry is all that the scene language needs of a new kind.
    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident {
            $(
                $(#[doc = $vdoc:literal])+
                $key:literal => $V:ident(
                    struct $S:ident $([$check:path])? { $($body:tt)* } $(with $flat:ident : $Flat:ty)*
                ),
            )+
        }
    ) => {
        describe! {
            $(#[doc = $doc])+
            pub enum $T {
                $( $(#[doc = $vdoc])+ $key => $V($S), )+
            }
        }
        $(
            describe! {
                $(#[doc = $vdoc])+
                pub struct $S $([$check])? { $($body)* } $(with $flat: $Flat)*
            }
        )+
    };

    // The same where every kind has the keys of another struct, which can be asked for whatever the kind.
    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident each with $each:ident : $Each:ident {
            $(
                $(#[doc = $vdoc:literal])+
                $key:literal => $V:ident(
                    struct $S:ident $([$check:path])? { $($body:tt)* } $(with $flat:ident : $Flat:ty)*
                ),
            )+
        }
    ) => {
        describe! {
            $(#[doc = $doc])+
            pub enum $T {
                $( $(#[doc = $vdoc])+ $key => $V($S), )+
            }
        }
        $(
            describe! {
                $(#[doc = $vdoc])+
                pub struct $S $([$check])? { $($body)* } $(with $flat: $Flat)* with $each: $Each
            }
        )+
        describe!(@each $T $each $Each { $( $V )+ });
    };

    // The same of kinds that are defined elsewhere, `with` the other struct.
    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident each has $each:ident : $Each:ident {
            $( $(#[doc = $vdoc:literal])+ $key:literal => $V:ident($P:ty), )+
        }
    ) => {
        describe! {
            $(#[doc = $doc])+
            pub enum $T {
                $( $(#[doc = $vdoc])+ $key => $V($P), )+
            }
        }
        describe!(@each $T $each $Each { $( $V )+ });
    };

    // The same of kinds of which some have it, which say so.
    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident some have $some:ident, $some_mut:ident : $Some:ident {
            $( $(#[doc = $vdoc:literal])+ $key:literal => $V:ident($P:ty) $(has $has:ident)?, )+
        }
    ) => {
        describe! {
            $(#[doc = $doc])+
            pub enum $T {
                $( $(#[doc = $vdoc])+ $key => $V($P), )+
            }
        }

        impl $T {
            #[doc = concat!("Its [`", stringify!($Some), "`], if it is of a kind that has one.")]
            pub const fn $some(&self) -> Option<&$Some> {
                match self {
                    $( Self::$V(kind) => describe!(@has kind $($has)?), )+
                }
            }

            /// The same, to be changed.
            pub const fn $some_mut(&mut self) -> Option<&mut $Some> {
                match self {
                    $( Self::$V(kind) => describe!(@has_mut kind $($has)?), )+
                }
            }
        }
    };

    (
        $(#[doc = $doc:literal])+
        pub enum $T:ident {
            $( $(#[doc = $vdoc:literal])+ $key:literal => $V:ident $(($P:ty))?, )+
        }
    ) => {
        $(#[doc = $doc])+
        #[derive(Clone, Debug, PartialEq)]
        // A scene has one camera, and few of what else differs much in size.
        #[allow(clippy::large_enum_variant)]
        pub enum $T {
            $( $(#[doc = $vdoc])+ $V $(($P))?, )+
        }

        impl $T {
            /// The keys of all kinds, in the order of the definition.
            pub const KINDS: &'static [&'static str] = &[$($key),+];

            /// What the bare key of a kind says; `None` where there is none of that key, or where it can't stand by itself.
            pub fn bare(kind: &str) -> Option<Self> {
                match kind {
                    $( $key => describe!(@bare $V $($P)?), )+
                    _ => None,
                }
            }

            /// The key of this kind.
            pub fn kind(&self) -> &'static str {
                match self {
                    $( Self::$V { .. } => $key, )+
                }
            }
        }

        impl $crate::decode::Describe for $T {
            fn read(
                tree: &$crate::tree::Tree,
                _: $crate::limit::Limit,
                d: &mut $crate::decode::Decoder,
            ) -> Self {
                let Some(choice) = d.choice(tree, Self::KINDS) else { return Self::blank() };
                match choice.kind {
                    $( $key => describe!(@read choice d $V $($P)?), )+
                    _ => Self::blank(),
                }
            }

            #[allow(unreachable_code)] // the first kind returns
            fn blank() -> Self {
                $( return describe!(@blank_variant $V $($P)?); )+
            }

            fn write_to(&self, out: &mut dyn $crate::writer::Writer) {
                match self {
                    $( describe!(@pattern inner $V $($P)?) => describe!(@write inner out $key $($P)?), )+
                }
            }

            fn schema(
                _: $crate::limit::Limit,
                defs: &mut $crate::schema::Definitions,
            ) -> ::serde_json::Value {
                defs.refer(stringify!($T), |defs| {
                    let mut choices = $crate::schema::Choices::default();
                    $( describe!(@choice choices defs $key [$($vdoc),+] $($P)?); )+
                    let _ = &defs;
                    choices.into_schema(&[$($doc),+])
                })
            }

            fn show<'a>(
                &'a self,
                _: $crate::limit::Limit,
                visitor: &mut dyn $crate::visit::Visitor<'a>,
            ) {
                match self {
                    $( describe!(@pattern inner $V $($P)?) => describe!(@show inner visitor $($P)?), )+
                }
            }

            fn lead(&mut self, places: &$crate::link::Places) {
                match self {
                    $( describe!(@pattern inner $V $($P)?) => describe!(@lead inner places $($P)?), )+
                }
            }
        }
    };

    // A struct whose every key has a default has one itself.
    (@default $T:ident { $( $f:ident = $default:expr, )* } { $( $flat:ident : $Flat:ty )* }) => {
        impl Default for $T {
            fn default() -> Self {
                Self { $( $f: $default, )* $( $flat: <$Flat>::default(), )* }
            }
        }
    };
    (@default $($other:tt)*) => {};

    (@limit) => { $crate::limit::Limit::FINITE };
    (@limit $limit:expr) => { $limit };

    (@absent $ty:ty) => { None };
    (@absent $ty:ty, $default:expr) => { Some((|| $default) as fn() -> $ty) };

    (@differs $self:ident $f:ident $ty:ty) => { true };
    (@differs $self:ident $f:ident $ty:ty, $default:expr) => {{
        let default: $ty = $default;
        default != $self.$f
    }};

    (@optional) => { false };
    (@optional $default:expr) => { true };

    (@blank $ty:ty) => { <$ty as $crate::decode::Describe>::blank() };
    (@blank $ty:ty, $default:expr) => { $default };

    (@check) => { |_, _, _| () };
    (@check $check:path) => { $check };

    (@read $choice:ident $d:ident $V:ident) => {{ $choice.nothing($d); Self::$V }};
    (@read $choice:ident $d:ident $V:ident $P:ty) => { Self::$V($choice.read::<$P>($d)) };

    (@blank_variant $V:ident) => { Self::$V };
    (@blank_variant $V:ident $P:ty) => { Self::$V(<$P as $crate::decode::Describe>::blank()) };

    (@bare $V:ident) => { Some(Self::$V) };
    (@bare $V:ident $P:ty) => {
        <$P as $crate::decode::Describe>::may_be_empty()
            .then(|| Self::$V(<$P as $crate::decode::Describe>::blank()))
    };

    (@pattern $inner:ident $V:ident) => { Self::$V };
    (@pattern $inner:ident $V:ident $P:ty) => { Self::$V($inner) };

    (@write $inner:ident $out:ident $key:literal) => { $out.text($key) };
    (@write $inner:ident $out:ident $key:literal $P:ty) => {
        $crate::decode::write_only($key, $inner, $out)
    };

    (@show $inner:ident $visitor:ident) => {{ let _ = $visitor; }};
    (@show $inner:ident $visitor:ident $P:ty) => {
        $crate::decode::Describe::show($inner, $crate::limit::Limit::FINITE, $visitor)
    };

    (@lead $inner:ident $places:ident) => {{ let _ = $places; }};
    (@lead $inner:ident $places:ident $P:ty) => { $crate::decode::Describe::lead($inner, $places) };

    (@has $kind:ident) => {{ let _ = $kind; None }};
    (@has $kind:ident $has:ident) => { Some(&$kind.$has) };

    (@has_mut $kind:ident) => {{ let _ = $kind; None }};
    (@has_mut $kind:ident $has:ident) => { Some(&mut $kind.$has) };

    (@each $T:ident $each:ident $Each:ident { $( $V:ident )+ }) => {
        impl $T {
            #[doc = concat!("Its [`", stringify!($Each), "`], which every kind has.")]
            pub const fn $each(&self) -> &$Each {
                match self {
                    $( Self::$V(kind) => &kind.$each, )+
                }
            }
        }
    };

    (@choice $choices:ident $defs:ident $key:literal [$($doc:literal),+]) => {
        $choices.word($key, &[$($doc),+]);
    };
    (@choice $choices:ident $defs:ident $key:literal [$($doc:literal),+] $P:ty) => {
        let payload = <$P as $crate::decode::Describe>::schema($crate::limit::Limit::FINITE, $defs);
        let may_be_empty = <$P as $crate::decode::Describe>::may_be_empty();
        $choices.payload($key, &[$($doc),+], payload, may_be_empty);
    };
}
pub(crate) use describe;
