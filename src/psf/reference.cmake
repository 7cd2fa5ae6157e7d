# The target `reference`: pages of the installed headers by Doxygen, in the folder reference of the build. A warning, as
# of something without a comment, is an error.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()

# The headers under the names that they have where they are installed.
set(include ${CMAKE_CURRENT_BINARY_DIR}/reference)
foreach(header IN LISTS headers)
  get_filename_component(path ${header} ABSOLUTE)
  get_filename_component(name ${header} NAME)
  file(MAKE_DIRECTORY ${include}/psf)
  file(CREATE_LINK ${path} ${include}/psf/${name} SYMBOLIC)
endforeach()

set(DOXYGEN_STRIP_FROM_PATH ${include})
set(DOXYGEN_STRIP_FROM_INC_PATH ${include})
set(DOXYGEN_USE_MDFILE_AS_MAINPAGE ${CMAKE_CURRENT_SOURCE_DIR}/README.md)
set(DOXYGEN_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
set(DOXYGEN_HTML_OUTPUT reference)
set(DOXYGEN_FILTER_PATTERNS "*.h=sed -f ${CMAKE_CURRENT_SOURCE_DIR}/reference.sed")
set(DOXYGEN_WARN_AS_ERROR FAIL_ON_WARNINGS)
set(DOXYGEN_QUIET YES)

# What stands behind a comment belongs to the line, and definitions for compilers to nobody.
set(DOXYGEN_MACRO_EXPANSION YES)
set(DOXYGEN_EXPAND_ONLY_PREDEF YES)
set(DOXYGEN_PREDEFINED PSF_API=)
set(DOXYGEN_EXCLUDE_SYMBOLS PVB_H_INCLUDED)

set(DOXYGEN_JAVADOC_AUTOBRIEF YES)
set(DOXYGEN_SORT_MEMBER_DOCS NO)
set(DOXYGEN_HAVE_DOT NO)
set(DOXYGEN_VERBATIM_HEADERS NO)
set(DOXYGEN_GENERATE_TREEVIEW YES)
set(DOXYGEN_TREEVIEW_WIDTH 320)
set(DOXYGEN_TYPEDEF_HIDES_STRUCT YES)
set(DOXYGEN_HIDE_UNDOC_RELATIONS YES)
find_file(PSF_DOXYGEN_STYLE doxygen-awesome.css PATHS /usr/share/doxygen-awesome-css)
if(PSF_DOXYGEN_STYLE)
  set(DOXYGEN_HTML_EXTRA_STYLESHEET ${PSF_DOXYGEN_STYLE})
endif()
set(pages README.md ../python/README.md ../../formats/README.md)
list(TRANSFORM pages PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
doxygen_add_docs(reference ${include} ${pages}
  COMMENT "Writing the reference of the library")
