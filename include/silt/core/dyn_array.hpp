// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <silt/core/target.hpp>

namespace silt::inline SILT_TARGET {

namespace detail {

/// Where a DynArray has its elements: on the heap, aligned as their type asks for.
struct HeapMemory {
  static void* get(std::size_t bytes, std::align_val_t align) {
    return ::operator new(bytes, align);
  }
  static void drop(void* elements, std::size_t, std::align_val_t align) {
    ::operator delete(elements, align);
  }
};

/// Bytes of n elements of the given size.
/// @throws std::length_error if there is no such memory
inline std::size_t bytes_of(std::size_t n, std::size_t size) {
  if (n > PTRDIFF_MAX / size) throw std::length_error("silt: an array of more bytes than memory");
  return n * size;
}

[[noreturn]] inline void throw_outside(std::size_t i, std::size_t n) {
  throw std::out_of_range("silt: element " + std::to_string(i) + " of " + std::to_string(n));
}

}  // namespace detail

/// What silt keeps lists in: a std::vector with the same members, which the compiler has less work
/// with. libstdc++ instantiates some 170 functions for each type of elements, this some 25 (100
/// types, each used in one function, g++ 12.2 -O3: 11.4 s and 3.7 s). It converts from and to a
/// std::vector by a copy. Iterators are pointers. Elements must move without exceptions. Compiled
/// with _GLIBCXX_ASSERTIONS, an index outside ends the program, as with std::vector.
template <class T, class Memory = detail::HeapMemory>
class DynArray {
 public:
  using value_type = T;
  using size_type = std::size_t;
  using difference_type = std::ptrdiff_t;
  using reference = T&;
  using const_reference = const T&;
  using iterator = T*;
  using const_iterator = const T*;

  DynArray() noexcept {}  // NOLINT: defaulted, it would be a function more for each constexpr use
  explicit DynArray(std::size_t n) : DynArray() { resize(n); }
  DynArray(std::size_t n, const T& value) : DynArray() { resize(n, value); }
  DynArray(std::initializer_list<T> values) : DynArray() { append(values.begin(), values.size()); }
  template <class I>
    requires(!std::is_arithmetic_v<I>)
  DynArray(I first, I last) : DynArray() {
    for (; first != last; ++first) push_back(*first);
  }
  DynArray(const std::vector<T>& other) : DynArray() {  // NOLINT: a std::vector is one
    append(other.data(), other.size());
  }
  DynArray(const DynArray& other) : DynArray() { append(other.data_, other.size_); }
  DynArray(DynArray&& other) noexcept
      : data_(other.data_), size_(other.size_), capacity_(other.capacity_) {
    other.data_ = nullptr;
    other.size_ = other.capacity_ = 0;
  }
  DynArray& operator=(const DynArray& other) {
    if (this != &other) assign(other.data_, other.data_ + other.size_);
    return *this;
  }
  DynArray& operator=(DynArray&& other) noexcept {
    DynArray taken(std::move(other));
    swap(taken);
    return *this;
  }
  operator std::vector<T>() const { return std::vector<T>(begin(), end()); }  // NOLINT: and back
  ~DynArray() {
    shorten(0);
    if (data_ != nullptr) Memory::drop(data_, capacity_ * sizeof(T), align);
  }

  [[gnu::always_inline]] T* begin() { return data_; }
  [[gnu::always_inline]] T* end() { return data_ + size_; }
  [[gnu::always_inline]] const T* begin() const { return data_; }
  [[gnu::always_inline]] const T* end() const { return data_ + size_; }
  [[gnu::always_inline]] T* data() { return data_; }
  [[gnu::always_inline]] const T* data() const { return data_; }
  [[gnu::always_inline]] std::size_t size() const { return size_; }
  [[gnu::always_inline]] std::size_t capacity() const { return capacity_; }
  [[gnu::always_inline]] bool empty() const { return size_ == 0; }
  [[gnu::always_inline]] T& operator[](std::size_t i) { return data_[inside(i)]; }
  [[gnu::always_inline]] const T& operator[](std::size_t i) const { return data_[inside(i)]; }
  [[gnu::always_inline]] T& front() { return data_[inside(0)]; }
  [[gnu::always_inline]] const T& front() const { return data_[inside(0)]; }
  [[gnu::always_inline]] T& back() { return data_[inside(size_ - 1)]; }
  [[gnu::always_inline]] const T& back() const { return data_[inside(size_ - 1)]; }
  /// @throws std::out_of_range
  T& at(std::size_t i) {
    if (i >= size_) detail::throw_outside(i, size_);
    return data_[i];
  }
  const T& at(std::size_t i) const {
    if (i >= size_) detail::throw_outside(i, size_);
    return data_[i];
  }

  void clear() { shorten(0); }
  void reserve(std::size_t n) {
    if (n > capacity_) move_to(n);
  }
  void resize(std::size_t n) {
    shorten(n);
    make_room(n);
    for (; size_ < n; ++size_) ::new (static_cast<void*>(data_ + size_)) T();
  }
  void resize(std::size_t n, const T& value) {
    if (n > capacity_) return resize(n, T(value), std::true_type());
    resize(n, value, std::true_type());
  }
  void assign(std::size_t n, const T& value) {
    const T kept(value);
    shorten(0);
    resize(n, kept, std::true_type());
  }
  template <class I>
    requires(!std::is_arithmetic_v<I>)
  void assign(I first, I last) {
    shorten(0);
    for (; first != last; ++first) push_back(*first);
  }
  void assign(const T* first, const T* last) {
    shorten(0);
    append(first, static_cast<std::size_t>(last - first));
  }
  void push_back(const T& value) {
    if (size_ < capacity_) {
      ::new (static_cast<void*>(data_ + size_)) T(value);
      ++size_;
    } else {
      push_grown(T(value));
    }
  }
  void push_back(T&& value) {
    if (size_ < capacity_) {
      ::new (static_cast<void*>(data_ + size_)) T(std::move(value));
      ++size_;
    } else {
      push_grown(T(std::move(value)));
    }
  }
  template <class... Args>
  T& emplace_back(Args&&... args) {
    push_back(T(std::forward<Args>(args)...));
    return back();
  }
  void pop_back() { shorten(size_ - 1); }

  T* insert(const T* at, const T& value) { return turn(at, [&] { push_back(value); }); }
  T* insert(const T* at, std::size_t n, const T& value) {
    return turn(at, [&] { resize(size_ + n, value); });
  }
  template <class I>
    requires(!std::is_arithmetic_v<I>)
  T* insert(const T* at, I first, I last) {
    return turn(at, [&] {
      for (; first != last; ++first) push_back(*first);
    });
  }
  T* insert(const T* at, std::initializer_list<T> values) {
    return insert(at, values.begin(), values.end());
  }
  T* erase(const T* first, const T* last) {
    T* to = data_ + (first - data_);
    for (T* from = data_ + (last - data_); from != end() && first != last; ++from, ++to) {
      *to = std::move(*from);
    }
    if (first != last) shorten(static_cast<std::size_t>(to - data_));
    return data_ + (first - data_);
  }
  T* erase(const T* at) { return erase(at, at + 1); }

  void swap(DynArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }
  friend void swap(DynArray& a, DynArray& b) noexcept { a.swap(b); }
  friend bool operator==(const DynArray& a, const DynArray& b) {
    return a.size_ == b.size_ && std::equal(a.begin(), a.end(), b.begin());
  }
  template <class F>
  friend std::size_t erase_if(DynArray& a, F&& leaves) {
    const std::size_t before = a.size_;
    a.erase(std::remove_if(a.begin(), a.end(), std::forward<F>(leaves)), a.end());
    return before - a.size_;
  }

 private:
  static constexpr bool by_bytes = std::is_trivially_copyable_v<T>;
  static constexpr std::align_val_t align{alignof(T)};

  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;

  [[gnu::always_inline]] std::size_t inside(std::size_t i) const {
#if defined(_GLIBCXX_ASSERTIONS)
    if (i >= size_) std::abort();
#endif
    return i;
  }
  void shorten(std::size_t n) {
    if constexpr (std::is_trivially_destructible_v<T>) {
      size_ = std::min(size_, n);
    } else {
      while (size_ > n) data_[--size_].~T();
    }
  }
  void make_room(std::size_t n) {
    if (n > capacity_) move_to(std::max(n, 2 * size_));
  }
  // To new memory for so many elements, at least as many as there are.
  void move_to(std::size_t capacity) {
    static_assert(by_bytes || std::is_nothrow_move_constructible_v<T>,
                  "elements of a DynArray move without exceptions");
    T* const place = static_cast<T*>(Memory::get(detail::bytes_of(capacity, sizeof(T)), align));
    if constexpr (by_bytes) {
      if (size_ > 0) std::memcpy(static_cast<void*>(place), data_, size_ * sizeof(T));
    } else {
      for (std::size_t i = 0; i < size_; ++i) {
        ::new (static_cast<void*>(place + i)) T(std::move(data_[i]));
        data_[i].~T();
      }
    }
    if (data_ != nullptr) Memory::drop(data_, capacity_ * sizeof(T), align);
    data_ = place;
    capacity_ = capacity;
  }
  void push_grown(T&& value) {  // not an element of this array
    move_to(size_ == 0 ? 1 : 2 * size_);
    ::new (static_cast<void*>(data_ + size_)) T(std::move(value));
    ++size_;
  }
  void resize(std::size_t n, const T& value, std::true_type) {
    shorten(n);
    make_room(n);
    for (; size_ < n; ++size_) ::new (static_cast<void*>(data_ + size_)) T(value);
  }
  void append(const T* from, std::size_t n) {
    make_room(size_ + n);
    if constexpr (by_bytes) {
      if (n > 0) std::memcpy(static_cast<void*>(data_ + size_), from, n * sizeof(T));
      size_ += n;
    } else {
      for (const std::size_t end = size_ + n; size_ < end; ++size_, ++from) {
        ::new (static_cast<void*>(data_ + size_)) T(*from);
      }
    }
  }
  // What `add` appends comes to stand at `at`.
  template <class F>
  T* turn(const T* at, F add) {
    const std::ptrdiff_t place = at - data_, old = static_cast<std::ptrdiff_t>(size_);
    add();
    std::rotate(data_ + place, data_ + old, end());
    return data_ + place;
  }
};

}  // namespace silt
