// Contacts of bodies, as arrays.
#include "proximity.h"
#include "values.h"

namespace sdm::python {

template <>
inline constexpr auto kMembers<SurfacePoint> = std::tuple{&SurfacePoint::face, &SurfacePoint::barycentric};
template <>
inline constexpr auto kMembers<Contact> =
    std::tuple{&Contact::point1, &Contact::point2, &Contact::normal, &Contact::depth,
               &Contact::patch,  &Contact::on,     &Contact::id};
template <>
inline constexpr auto kMembers<PyContacts> =
    std::tuple{&PyContacts::contacts, &PyContacts::bodies, &PyContacts::parts, &PyContacts::has_bodies};

namespace {

template <class Get>
auto contacts_column(LazyArray PyContacts::*array, Get get) {
  return [array, get](PyContacts& self) {
    return (self.*array).get([&] { return column(self.contacts, get); });
  };
}

/// A column of pairs, which only contacts of many bodies have.
auto pair_column_of_contacts(LazyArray PyContacts::*array,
                             std::vector<std::array<std::uint32_t, 2>> PyContacts::*pairs) {
  return [array, pairs](PyContacts& self) -> nb::object {
    if (!self.has_bodies) return nb::none();
    return (self.*array).get([&] { return column(self.*pairs, [](const auto& pair) { return pair; }); });
  };
}

void bind_contact_features(nb::class_<PyContacts>& type) {
  type.def_prop_ro("faces",
                   contacts_column(&PyContacts::faces,
                                   [](const Contact& c) {
                                     return std::array{c.on[0].face, c.on[1].face};
                                   }),
                   nb::sig("def faces(self) -> numpy.typing.NDArray[numpy.uint32]"),
                   "A face of O1 that contains point1 and one of O2 that contains point2, (n, 2) uint32.")
      .def_prop_ro("barycentric",
                   contacts_column(&PyContacts::barycentric,
                                   [](const Contact& c) {
                                     return std::array{c.on[0].barycentric, c.on[1].barycentric};
                                   }),
                   nb::sig("def barycentric(self) -> numpy.typing.NDArray[numpy.float64]"),
                   "The barycentric coordinates of the points in these faces, (n, 2, 3) float64.");
}

}  // namespace

void bind_contacts(nb::module_& module) {
  nb::class_<PyContacts> type(
      module, "Contacts", nb::is_weak_referenceable(),
      R"(Contacts as arrays with one row each, sorted by patch, the patch with the deepest contact
first, and by decreasing depth within a patch; those of many bodies first by pair of bodies.)");
  bind_columns<Contact>(
      type, &PyContacts::columns, [](const PyContacts& self) -> auto& { return self.contacts; });
  bind_contact_features(type);
  type.def_prop_ro("bodies", pair_column_of_contacts(&PyContacts::body, &PyContacts::bodies),
                   nb::sig("def bodies(self) -> numpy.typing.NDArray[numpy.uint32] | None"),
                   "The indices of O1 and O2, (n, 2) uint32, for MultiBodyQuery; otherwise None.")
      .def_prop_ro(
          "parts", pair_column_of_contacts(&PyContacts::part, &PyContacts::parts),
          nb::sig("def parts(self) -> numpy.typing.NDArray[numpy.uint32] | None"),
          "The parts of O1 and O2 (see Compound), (n, 2) uint32, for MultiBodyQuery; otherwise None.")
      .def("__len__", [](const PyContacts& self) { return self.contacts.size(); })
      .def("__repr__",
           [](const PyContacts& self) { return nb::str("sdm.Contacts({})").format(self.contacts.size()); });
  bind_value<PyContacts>([](const PyContacts& contacts) {
    const std::size_t rows = contacts.has_bodies ? contacts.contacts.size() : 0;
    if (contacts.bodies.size() != rows || contacts.parts.size() != rows) throw Error(kDamaged);
  });
}

}  // namespace sdm::python
