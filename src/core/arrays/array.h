// Arrays that own their elements, or view those of a file.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace sdm::core {

/// A std::vector, or a view of writable memory that this array alone refers to, and that an owner keeps
/// alive. Reading and changing elements is the same for both; a view becomes a vector when its size changes.
/// Copies are vectors.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;
  using iterator = T*;
  using const_iterator = const T*;

  Array() = default;
  Array(std::vector<T> items) noexcept : own_(std::move(items)) { follow(); }  // NOLINT: as it is one
  Array(std::size_t count, const T& value) : Array(std::vector<T>(count, value)) {}
  Array(std::span<T> items, std::shared_ptr<const void> owner) noexcept
      : data_(items.data()), size_(items.size()), owner_(std::move(owner)) {}

  Array(const Array& other) : Array(std::vector<T>(other.begin(), other.end())) {}
  Array(Array&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)),
        size_(std::exchange(other.size_, 0)),
        own_(std::move(other.own_)),
        owner_(std::move(other.owner_)) {}
  /// Allocates nothing if the elements fit.
  Array& operator=(const Array& other) {
    if (this == &other) return *this;
    if (size_ == other.size_)
      std::copy(other.begin(), other.end(), begin());
    else
      assign(other.begin(), other.end());
    return *this;
  }
  Array& operator=(Array&& other) noexcept {
    data_ = std::exchange(other.data_, nullptr);
    size_ = std::exchange(other.size_, 0);
    own_ = std::move(other.own_);
    owner_ = std::move(other.owner_);
    return *this;
  }
  ~Array() = default;

  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }
  [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] T& front() { return data_[0]; }
  [[nodiscard]] const T& front() const { return data_[0]; }
  [[nodiscard]] T& back() { return data_[size_ - 1]; }
  [[nodiscard]] const T& back() const { return data_[size_ - 1]; }

  // As those of std::vector.
  void resize(std::size_t size) {
    resized([&](std::vector<T>& items) { items.resize(size); });
  }
  void reserve(std::size_t size) {
    resized([&](std::vector<T>& items) { items.reserve(size); });
  }
  [[nodiscard]] std::size_t capacity() const { return owner_ ? size_ : own_.capacity(); }
  void shrink_to_fit() {
    resized([](std::vector<T>& items) { items.shrink_to_fit(); });
  }
  void clear() noexcept {
    owner_.reset();
    own_.clear();
    follow();
  }
  void assign(std::size_t count, const T& value) {
    resized([&](std::vector<T>& items) { items.assign(count, value); });
  }
  template <class Iterator>
  requires(!std::is_integral_v<Iterator>) void assign(Iterator first, Iterator last) {
    resized([&](std::vector<T>& items) { items.assign(first, last); });
  }
  void push_back(const T& item) {
    resized([&](std::vector<T>& items) { items.push_back(item); });
  }
  void pop_back() {
    resized([](std::vector<T>& items) { items.pop_back(); });
  }
  /// The elements, without copying them if they are those of a vector.
  [[nodiscard]] std::vector<T> to_vector() && {
    resized([](std::vector<T>&) {});
    data_ = nullptr, size_ = 0;
    return std::move(own_);
  }
  /// Adds elements at the end.
  template <class Iterator>
  void append(Iterator first, Iterator last) {
    resized([&](std::vector<T>& items) { items.insert(items.end(), first, last); });
  }

 private:
  template <class Change>
  void resized(const Change& change) {
    if (owner_) {
      own_.assign(data_, data_ + size_);
      follow();
      owner_.reset();
    }
    change(own_);
    follow();
  }
  void follow() noexcept {
    data_ = own_.data();
    size_ = own_.size();
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::vector<T> own_;                 ///< empty for a view
  std::shared_ptr<const void> owner_;  ///< null for a vector
};

}  // namespace sdm::core

namespace sdm {
using namespace core;  // used unqualified in every folder
}
